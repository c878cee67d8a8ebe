'use strict';
// Residuals in time and against inputs, and the variation of the parameters of single frames.

/// Distances of a trial in mm: of one body, or the rms of all at each instant (body < 0).
function distances(trial, body, phase) {
  if (body >= 0) return scaled(trial.bodies[body][phase] || [], 1e3);
  const there = trial.bodies.filter(one => one[phase]);
  return trial.t.map((_, i) => { const value = rms(there.map(one => one[phase][i])); return present(value) ? 1e3 * value : null; });
}

function inTime() {
  const trials = data.trials.filter(trial => trial.t.length && trial.bodies.length);
  if (!trials.length) return null;
  const place = plotPlace('distance between measured and modelled bodies in time, with the inputs below');
  let shown = 0, body = -1;
  const bodies = [...new Set(trials.flatMap(trial => trial.bodies.map(one => one.name)))];
  const show = () => {
    const trial = trials[shown], units = [...new Set(trial.inputs.map(input => input.unit))], broken = brokenBy(trial.t);
    const index = body < 0 ? -1 : trial.bodies.findIndex(one => one.name === bodies[body]);
    const traces = body >= 0 && index < 0 ? [] : phases.map(phase => phaseLine(phase, {mode: 'lines', x: broken(trial.t), y: broken(distances(trial, index, phase)),
      line: {color: looks[phase].color, width: phase === 'before' ? 1.4 : 3.6},  // dashes are lost in noise
      hovertemplate: '%{x:.1f} s: %{y:.2f} mm'}));
    const rows = units.length, height = 0.5 / Math.max(rows, 2), dashes = ['solid', 'dot', 'dash', 'dashdot', 'longdash'];
    const axes = {}, seen = {};
    units.forEach((unit, u) => {
      const n = String(u + 2), bottom = (rows - 1 - u) * height;
      axes['yaxis' + n] = axis(shownUnit(unit).shown, {domain: [bottom, bottom + 0.82 * height], nticks: 4});
      trial.inputs.filter(input => input.unit === unit).forEach(input => {
        seen[unit] = (seen[unit] || 0) + 1;
        traces.push({type: 'scatter', mode: 'lines', name: plain(short(input.name)), x: trial.t, y: scaled(input.values, shownUnit(unit).scale), yaxis: 'y' + n,
          line: {width: 2.2, color: ['#111', '#6b6b6b', '#7a4a9e', '#2e6b3a', '#8a6d00'][(seen[unit] - 1) % 5], dash: dashes[(seen[unit] - 1) % 5]}});
      });
    });
    const levels = report.noise_floor_m > 0 ? [level(1e3 * report.noise_floor_m, narrow ? 'noise<br>alone' : 'measurement<br>noise alone', 'dot', false)] : [];
    draw(place, traces, layout(430 + 110 * rows, {shapes: levels.map(one => one.shape), annotations: levels.map(one => one.note), margin: {l: 70, r: narrow ? 60 : 130, t: 64, b: 60},
      xaxis: axis('time / s', {anchor: rows ? 'y' + (rows + 1) : 'y'}),
      yaxis: axis('distance / mm', {domain: [rows ? rows * height + 0.02 : 0, 1], rangemode: 'tozero'}), ...axes}));
  };
  return {nodes: [element('div', {class: 'controls'}, choice('trial', trials.map(trial => trial.name), i => { shown = i; show(); }),
    choice('body', ['all bodies (rms)', ...bodies], i => { body = i - 1; show(); })), place], draw: show};
}

/// Medians of y in bins of x that hold equally many points.
function medians(x, y, bins) {
  const points = x.map((value, i) => [value, y[i]]).sort((a, b) => a[0] - b[0]);
  const middle = list => list.sort((a, b) => a - b)[Math.floor(list.length / 2)];
  const result = {x: [], y: []};
  for (let b = 0; b < bins; ++b) {
    const part = points.slice(Math.floor(b * points.length / bins), Math.floor((b + 1) * points.length / bins));
    if (part.length < 3) continue;
    result.x.push(middle(part.map(one => one[0])));
    result.y.push(middle(part.map(one => one[1])));
  }
  return result;
}

function againstInputs() {
  const inputs = new Map();
  data.trials.forEach(trial => trial.inputs.forEach(input => inputs.set(input.name, input.unit)));
  if (!inputs.size || !data.trials.some(trial => trial.bodies.length)) return null;
  const list = [...inputs.keys()];
  const place = plotPlace('distance between measured and modelled bodies against an input');
  const byPhase = {};
  phases.forEach(phase => { byPhase[phase] = data.trials.map(trial => distances(trial, -1, phase)); });
  const words = element('p', {'aria-live': 'polite'});
  let shown = 0;
  const show = () => {
    const name = list[shown], unit = shownUnit(inputs.get(name)), traces = [], notes = [];
    phases.forEach((phase, panel) => {
      const x = [], y = [];
      data.trials.forEach((trial, k) => {
        const input = trial.inputs.find(one => one.name === name);
        if (input) input.values.forEach((value, i) => { if (present(value) && present(byPhase[phase][k][i])) { x.push(unit.scale * value); y.push(byPhase[phase][k][i]); } });
      });
      const step = Math.ceil(x.length / 1200), some = values => values.filter((_, i) => i % step === 0);
      const axes = panel ? {xaxis: 'x2', yaxis: 'y2'} : {};
      traces.push(Object.assign({type: 'scatter', mode: 'markers', showlegend: false, x: some(x), y: some(y), hovertemplate: '%{x:.3g}: %{y:.2f} mm',
        marker: {color: looks[phase].color, size: 5, opacity: 0.35, symbol: phase === 'before' ? 'circle' : 'diamond'}}, axes));
      const middle = medians(x, y, new Set(x).size < 8 ? new Set(x).size : 12);
      traces.push(Object.assign({type: 'scatter', mode: 'lines+markers', showlegend: false, x: middle.x, y: middle.y, hovertemplate: 'median %{y:.2f} mm',
        line: {color: ink, width: 4, dash: looks[phase].dash}, marker: {color: ink, size: 10, symbol: 'square'}}, axes));
      notes.push({text: looks[phase].name, xref: 'x' + (panel ? '2' : '') + ' domain', yref: 'paper', x: 0.5, y: 1, yanchor: 'bottom', showarrow: false, font: {size: 18}});
    });
    const p = structure => Object.prototype.hasOwnProperty.call(structure.by_input_p, name) ? structure.by_input_p[name] : null;
    const ps = [p(report.residual_structure_before), p(report.residual_structure)].slice(0, phases.length);
    words.textContent = 'Black squares: medians. A flat row of them means that the error does not go with this input' +
      (ps.some(present) ? '; p of no dependence: ' + ps.map((value, i) => looks[phases[i]].name + ' ' + pValue(value)).join(', ') : '') + '.';
    const title = withUnit(plain(short(name)), inputs.get(name));
    const columns = phases.length;
    draw(place, traces, layout(430, {annotations: notes, xaxis: axis(title, {domain: [0, columns > 1 ? 0.47 : 1]}), yaxis: axis('distance, rms of bodies / mm', {rangemode: 'tozero'}),
      ...(columns > 1 ? {xaxis2: axis(title, {domain: [0.53, 1], anchor: 'y2'}), yaxis2: axis('', {matches: 'y', anchor: 'x2', showticklabels: false})} : {})}));
  };
  return {nodes: [element('div', {class: 'controls'}, choice('input', list, i => { shown = i; show(); })), words, place], draw: show};
}

function parameterVariation() {
  const list = data.parameter_variation.filter(one => one.x.length);
  if (!list.length) return null;
  const places = list.map(one => plotPlace(one.parameter + ' of single frames against ' + one.against));
  const show = () => list.forEach((one, i) => {
    const x = shownUnit(one.against_unit), y = shownUnit(one.unit), order = one.x.map((_, k) => k).sort((a, b) => one.x[a] - one.x[b]);
    const xs = order.map(k => x.scale * one.x[k]);
    draw(places[i], [
      {type: 'scatter', mode: 'markers', name: 'single frames', x: xs, y: order.map(k => present(one.value[k]) ? y.scale * one.value[k] : null), marker: {color: '#444', size: 6, symbol: 'circle'}, hovertemplate: '%{x:.4g}: %{y:.4g}'},
      {type: 'scatter', mode: 'lines', name: 'the arm’s law', x: xs, y: order.map(k => present(one.law[k]) ? y.scale * one.law[k] : null), line: {color: looks.after.color, width: 4}, hovertemplate: '%{x:.4g}: %{y:.4g}'}],
      layout(330, {margin: {l: 70, r: 10, t: 40, b: 60}, showlegend: false, xaxis: axis(withUnit(plain(short(one.against)), one.against_unit)), yaxis: axis(withUnit(plain(one.parameter), one.unit))}));
  });
  return {nodes: [element('p', {class: 'hint'}, 'EI, M0, φ and L as fitted to each frame alone, against what they should not depend on, or not more than the law says. ' +
      'What a fit of single frames hides shows here. Dots: single frames; line: the arm’s law.'),
    element('p', {class: 'hint'}, '▲: a dependence beyond what chance makes in any of the plots (p < 0.01). Chance is estimated by exchanging stretches of two seconds.'),
    element('div', {class: 'grid'}, list.map((one, i) => element('div', null,
      element('h3', null, one.p < 0.01 ? '▲ ' : '', named(one.parameter), ' against ', named(one.against)),
      element('p', null, (one.p < 0.01 ? 'varies beyond the law' : 'no variation beyond the law seen') + ', p ' + (one.p < 1e-4 ? '' : '= ') + pValue(one.p)),
      one.sentence ? element('p', null, one.sentence) : null, places[i])))], draw: show};
}
