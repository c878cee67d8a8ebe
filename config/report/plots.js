'use strict';
// The plots of the arm, along it, of its trials and of its estimates. Before: dashed, open circles, dark orange.
// After: solid, diamonds, blue. Measured: black squares.

const ink = '#111', grid = '#d5d9dd';
const looks = {
  before: {color: '#a63c06', dash: 'dash', symbol: 'circle-open', name: 'before'},
  after: {color: '#00508f', dash: 'solid', symbol: 'diamond', name: 'after'},
};
const isSmall = place => place.closest('.grid') !== null;
const narrow = innerWidth < 700;  // a telephone, or half a window
const font = {family: 'system-ui, "Segoe UI", Roboto, Arial, "DejaVu Sans", sans-serif', size: narrow ? 12 : 16, color: ink};
const drawn = [];  // places of plots, for print

/// Keys of looks that differ in this diagnosis: without effects there is no "after".
const phases = anyEffect ? ['before', 'after'] : ['before'];
if (phases.length === 1) looks.before.name = 'model as it is';

/// In lines that fit; <br> that are there stay.
function inLines(title, most) {
  return title.split('<br>').map(part => part.split(' ').reduce((lines, word) => {
    const last = lines[lines.length - 1];
    if (last !== undefined && last.length + word.length < most) lines[lines.length - 1] = last + ' ' + word; else lines.push(word);
    return lines;
  }, []).join('<br>')).join('<br>');
}

function axis(title, more) {
  const share = more && more.domain ? more.domain[1] - more.domain[0] : 1;
  return Object.assign({title: {text: narrow ? inLines(title, Math.round(36 * share)) : title, font: {size: font.size}, standoff: 8}, gridcolor: grid, zerolinecolor: '#8a8a8a', linecolor: ink, showline: true,
    ticks: 'outside', automargin: true}, more);
}

function layout(height, more) {
  return Object.assign({height, font, paper_bgcolor: '#fff', plot_bgcolor: '#fff', margin: {l: 70, r: 20, t: 40, b: 60}, hovermode: 'closest',
    hoverlabel: {font: {size: 15}, namelength: -1}, legend: {orientation: 'h', x: 0, y: 1.02, yanchor: 'bottom', font: {size: font.size}}}, more,
    narrow && more && more.legend ? {legend: Object.assign({}, more.legend, {font: {size: font.size}})} : {});
}

/// Through points of a smooth curve (columns x, y, z), three more between neighbours: Catmull's and Rom's curve.
function smooth(columns) {
  return columns.map(v => v.flatMap((_, i) => {
    if (i + 1 >= v.length || v.length > 60) return [v[i]];
    const a = i > 0 ? v[i - 1] : 2 * v[i] - v[i + 1], b = v[i], c = v[i + 1], d = i + 2 < v.length ? v[i + 2] : 2 * c - b;
    return [0, 0.25, 0.5, 0.75].map(u => b + 0.5 * u * (c - a + u * (2 * a - 5 * b + 4 * c - d + u * (3 * (b - c) + d - a))));
  }));
}

/// Calls what it returns with a list to have it broken where times are apart by more than usual: what was left out is no line.
function brokenBy(times) {
  const steps = times.slice(1).map((t, i) => t - times[i]), usual = [...steps].sort((a, b) => a - b)[Math.floor(steps.length / 2)];
  return values => values.flatMap((value, i) => i > 0 && steps[i - 1] > 3 * usual ? [null, value] : [value]);
}

/// A name beside an axis: in a narrow window its parts below one another.
function beside(name) {
  return narrow ? String(name).split('.').map(part => plain(short(part, 16))).join('<br>') : plain(short(name));
}

/// Place of a plot; `words` says to those who cannot see it what it shows.
function plotPlace(words) {
  return element('div', {class: 'picture', role: 'img', 'aria-label': words});
}

function draw(place, traces, plotLayout) {
  if (!drawn.includes(place)) drawn.push(place);
  Plotly.react(place, traces, plotLayout, {responsive: true, displaylogo: false, displayModeBar: narrow || isSmall(place) ? false : 'hover', showSendToCloud: false,
    modeBarButtonsToRemove: ['lasso2d', 'select2d', 'toggleSpikelines'], toImageButtonOptions: {format: 'svg'}})
    .catch(error => errors.push(String(error)));
}

function phaseLine(phase, more) {
  const look = looks[phase];
  return Object.assign({type: 'scatter', mode: 'lines+markers', name: look.name, legendgroup: phase, line: {color: look.color, dash: look.dash, width: 3},
    marker: {color: look.color, symbol: look.symbol, size: 11, line: {width: 2.5, color: look.color}}}, more);
}

/// A line across the plot with its words on it: no legend to look up.
function level(at, words, dash, vertical, xanchor) {
  return {shape: Object.assign({type: 'line', line: {color: ink, width: 2, dash}, layer: 'below'},
      vertical ? {x0: at, x1: at, yref: 'paper', y0: 0, y1: 1} : {y0: at, y1: at, xref: 'paper', x0: 0, x1: 1}),
    note: Object.assign({text: words, showarrow: false, font: {size: 14}, bgcolor: 'rgba(255,255,255,0.8)'},
      vertical ? {x: at, yref: 'paper', y: 1, yanchor: 'bottom', xanchor: xanchor || 'center'}
               : {y: at, xref: 'paper', x: 1, xanchor: 'left', yanchor: 'middle'})};
}

// --- The arm ------------------------------------------------------------------------------------------------------

/// rms distance of points to a curve of straight pieces; both as columns x, y, z.
function distanceTo(curve, points) {
  const at = (columns, i) => columns.map(column => column[i]);
  const distances = points[0].map((_, i) => {
    const p = at(points, i);
    let nearest = Infinity;
    for (let k = 0; k + 1 < curve[0].length; ++k) {
      const a = at(curve, k), b = at(curve, k + 1);
      const ab = b.map((v, c) => v - a[c]), ap = p.map((v, c) => v - a[c]);
      const length2 = ab.reduce((sum, v) => sum + v * v, 0);
      const share = length2 > 0 ? Math.min(1, Math.max(0, ab.reduce((sum, v, c) => sum + v * ap[c], 0) / length2)) : 0;
      nearest = Math.min(nearest, Math.hypot(...ap.map((v, c) => v - share * ab[c])));
    }
    return nearest;
  });
  return rms(distances);
}

/// Across the base's axis towards where the arm reaches farthest, across that, and along the base's axis; in mm.
function inItsPlane(snapshot) {
  const [x, y] = snapshot.measured, x0 = snapshot.before[0][0], y0 = snapshot.before[1][0];
  let far = 0;
  x.forEach((_, i) => { if (Math.hypot(x[i] - x0, y[i] - y0) > Math.hypot(x[far] - x0, y[far] - y0)) far = i; });
  const angle = Math.atan2(y[far] - y0, x[far] - x0);
  const turn = columns => [columns[0].map((v, i) => 1e3 * (Math.cos(angle) * v + Math.sin(angle) * columns[1][i])),
    columns[0].map((v, i) => 1e3 * (Math.cos(angle) * columns[1][i] - Math.sin(angle) * v)), columns[2].map(v => 1e3 * v)];
  return Object.fromEntries(['measured', 'before', 'after', 'bodies_before', 'bodies_after'].map(one => [one, turn(phases.includes(one) ? smooth(snapshot[one]) : snapshot[one])]));
}

function armPlanes(place, snapshot) {
  const turned = inItsPlane(snapshot), traces = [];
  const side = 1.2 * Math.max(8, ...['measured', ...phases].flatMap(one => turned[one][1].map(Math.abs)));  // 1 mm is not to fill the plot
  [['x', 0], ['x2', 1]].forEach(([xaxis, column], panel) => {
    const common = {xaxis, yaxis: panel ? 'y2' : 'y', showlegend: panel === 0, hovertemplate: '%{x:.1f}, %{y:.1f} mm'};
    phases.forEach(phase => traces.push(phaseLine(phase, Object.assign({mode: 'lines', x: turned[phase][column], y: turned[phase][2]}, common)),
      bodiesOf(phase, Object.assign({type: 'scatter', x: turned['bodies_' + phase][column], y: turned['bodies_' + phase][2]}, common))));
    traces.push(Object.assign({type: 'scatter', mode: 'markers', name: 'measured', legendgroup: 'measured', x: turned.measured[column], y: turned.measured[2],
      marker: {color: ink, symbol: 'square', size: 10}}, common));
  });
  draw(place, traces, layout(560, {
    xaxis: axis('in its plane of bending / mm', {domain: [0, 0.58]}), yaxis: axis('along the base’s axis / mm', {scaleanchor: 'x'}),
    xaxis2: axis('across that plane / mm<br>(other scale)', {domain: [0.7, 1], anchor: 'y2', range: [-side, side]}),
    yaxis2: axis('', {matches: 'y', anchor: 'x2', showticklabels: false})}));
}

const xyz = columns => ({x: scaled(columns[0], 1e3), y: scaled(columns[1], 1e3), z: scaled(columns[2], 1e3)});

/// Where the model has the bodies: one that sits elsewhere than the arm file says lies beside the line.
function bodiesOf(phase, more) {
  const {color, symbol} = looks[phase];
  return Object.assign({mode: 'markers', name: 'bodies ' + looks[phase].name, legendgroup: phase + 'bodies',
    marker: {color, symbol: symbol.replace('-open', '') + '-open', size: 13, line: {width: 2, color}}}, more);
}

/// @param cube half of a side and the middle, mm; of all instants of a film
function armInSpace(place, snapshot, cube) {
  const traces = phases.flatMap(phase => [Object.assign({type: 'scatter3d', mode: 'lines', name: looks[phase].name,
    line: {color: looks[phase].color, width: 7, dash: looks[phase].dash}}, xyz(smooth(snapshot[phase]))),
    Object.assign(bodiesOf(phase, {type: 'scatter3d', showlegend: false}), {marker: {color: looks[phase].color, symbol: phase === 'before' ? 'circle-open' : 'diamond-open', size: 6}},
      xyz(snapshot['bodies_' + phase]))]);
  traces.push(Object.assign({type: 'scatter3d', mode: 'markers', name: 'measured', marker: {color: ink, symbol: 'square', size: 5}}, xyz(snapshot.measured)));
  const [x, y, z] = cube.middle.map((middle, i) => ({title: {text: 'xyz'[i] + ' / mm', font: {size: 15}}, range: [middle - cube.half, middle + cube.half],
    tickfont: {size: 12}, nticks: 6}));
  draw(place, traces, layout(640, {margin: {l: 0, r: 0, t: 40, b: 0}, uirevision: 'space',  // the view stays as it was turned
    scene: {aspectmode: 'cube', xaxis: x, yaxis: y, zaxis: z, camera: {eye: {x: 1.1, y: -1.3, z: 0.35}}, uirevision: 'space'}}));
}

/// The same scale on all axes.
function cubeOf(snapshots) {
  const spans = [0, 1, 2].map(c => {
    const all = snapshots.flatMap(one => [one.before, one.after, one.measured].flatMap(columns => columns[c])).filter(present).map(v => 1e3 * v);
    return [Math.min(...all), Math.max(...all)];
  });
  return {middle: spans.map(([low, high]) => (low + high) / 2), half: 0.55 * Math.max(...spans.map(([low, high]) => high - low))};
}

function arm() {
  const films = data.trials.filter(trial => trial.film.length > 1).map(trial => trial.film.map(one => ({...one, trial: trial.name})));
  const shots = data.snapshots.filter(one => one.measured[0].length && one.before[0].length);
  if (!shots.length) return null;
  const place = plotPlace('the arm, measured and modelled, in two planes'), words = element('p');
  let shown = 0, space = false, film = -1, at = 0, timer = 0;
  const cubes = films.map(() => null);
  const cube = () => film < 0 ? cubeOf([shots[shown]]) : cubes[film] || (cubes[film] = cubeOf(films[film]));
  const show = () => {
    const shot = film < 0 ? shots[shown] : films[film][at], off = phase => mm(distanceTo(shot[phase], shot.measured));
    words.replaceChildren('In ', named(shot.trial), ' at ' + shot.t.toFixed(1) + ' s the measured bodies lie ' + off('before') + ' (rms) off the model' +
      (phases.length > 1 ? ' before and ' + off('after') + ' after.' : '.'));
    if (space !== (place.dataset.space === 'yes')) Plotly.purge(place);
    place.dataset.space = space ? 'yes' : 'no';
    space ? armInSpace(place, shot, cube()) : armPlanes(place, shot);
    slider.value = String(at);
  };
  const turn = element('button', {type: 'button'}, 'show in 3D');
  const inSpace = wanted => { space = wanted; turn.textContent = space ? 'show in two planes' : 'show in 3D'; };
  turn.addEventListener('click', () => { inSpace(!space); show(); });
  const slider = element('input', {type: 'range', min: '0', max: '0', step: '1', 'aria-label': 'instant of the trial'});
  const play = element('button', {type: 'button'}, 'play');
  const stop = () => { clearInterval(timer); timer = 0; play.textContent = 'play'; };
  play.addEventListener('click', () => {
    if (timer) return stop();
    play.textContent = 'stop';
    timer = setInterval(() => { at = (at + 1) % films[film].length; show(); }, 150);
  });
  slider.addEventListener('input', () => { stop(); at = Number(slider.value); show(); });
  const moving = element('span', {class: 'controls', hidden: ''}, play, slider);
  const list = choice('instant', [...shots.map(shot => shot.description + ': ' + shot.trial + ', ' + shot.t.toFixed(1) + ' s'), ...films.map(one => 'moving: ' + one[0].trial)], i => {
    stop();
    film = i < shots.length ? -1 : i - shots.length;
    at = 0;
    if (film < 0) shown = i; else slider.max = String(films[film].length - 1);
    moving.hidden = film < 0;
    inSpace(film >= 0);
    show();
  });
  return {nodes: [element('div', {class: 'controls'}, list, moving, turn), words, place], draw: show};
}

// --- The tip --------------------------------------------------------------------------------------------------------

/// The tip over an input, where loops show, and over time.
function tipLoop() {
  const trials = data.trials.filter(trial => trial.t.length && trial.tip.measured[0].some(present) && trial.inputs.length);
  if (!trials.length) return null;
  const place = plotPlace('the tip over an input and over time, measured and predicted from the other trials');
  const spread = c => { const all = trials.flatMap(trial => trial.tip.measured[c]).filter(present); return Math.max(...all) - Math.min(...all); };
  const names = [...new Set(trials.flatMap(trial => trial.inputs.map(input => input.name)))];
  let shown = 0, input = 0, side = [0, 1, 2].sort((a, b) => spread(b) - spread(a))[0];
  const show = () => {
    const trial = trials[shown], driven = trial.inputs.find(one => one.name === names[input]), traces = [];
    const unit = shownUnit(driven ? driven.unit : ''), broken = brokenBy(trial.t);
    const lines = [['measured', {name: 'measured', legendgroup: 'measured', line: {color: ink, width: 2}}],
      ...phases.map(phase => [phase, {name: looks[phase].name, legendgroup: phase, line: {color: looks[phase].color, dash: phase === 'before' ? 'dash' : 'solid', width: phase === 'before' ? 2 : 3}}])];
    lines.forEach(([key, look]) => {
      const y = broken(scaled(trial.tip[key][side], 1e3)), common = {type: 'scatter', mode: 'lines', connectgaps: false, y, ...look};
      if (driven) traces.push({...common, x: broken(scaled(driven.values, unit.scale)), hovertemplate: '%{x:.3g}: %{y:.2f} mm'});
      traces.push({...common, x: broken(trial.t), xaxis: 'x2', yaxis: 'y2', showlegend: !driven, hovertemplate: '%{x:.1f} s: %{y:.2f} mm'});
    });
    draw(place, traces, layout(470, {xaxis: axis(withUnit(plain(short(names[input])), driven ? driven.unit : ''), {domain: [0, 0.44]}), yaxis: axis('tip, ' + 'xyz'[side] + ' / mm', {zeroline: false}),
      xaxis2: axis('time / s', {domain: [0.52, 1], anchor: 'y2'}), yaxis2: axis('', {matches: 'y', anchor: 'x2', showticklabels: false, zeroline: false})}));
  };
  return {nodes: [element('p', {class: 'hint'}, 'Predicted from the other trials. Where up and down differ at the same input, there is a loop: memory, or the action of another input. Axes of the base frame.'),
    element('div', {class: 'controls'}, choice('trial', trials.map(trial => trial.name), i => { shown = i; show(); }), choice('over', names, i => { input = i; show(); }),
      choice('along', ['x', 'y', 'z'].map((name, c) => name + ' (moves ' + (1e3 * spread(c)).toFixed(0) + ' mm)'), c => { side = c; show(); }, side)), place], draw: show};
}

// --- Along the arm --------------------------------------------------------------------------------------------------

function along() {
  const a = data.along;
  if (!a.s.length || a.before[0].length !== a.s.length) return null;
  const place = plotPlace('residuals along the arm on three axes, before and after');
  let mean = false;
  const heads = ['in the plane of bending', 'across that plane', 'along the arm'];
  const show = () => {
    const traces = [], shapes = [], notes = [], last = a.s.length ? 1e3 * Math.max(...a.s) : 0;
    heads.forEach((head, c) => {
      const n = c === 0 ? '' : String(c + 1);
      phases.forEach(phase => traces.push(phaseLine(phase, {x: scaled(a.s, 1e3), y: scaled(a[(mean ? 'mean_' : '') + phase][c], 1e3), xaxis: 'x' + n,
        yaxis: 'y' + n, showlegend: c === 0, text: a.bodies.map(name => plain(name)), hovertemplate: '%{text}: %{y:.2f} mm'})));
      [...report.effects, ...(restSits() ? [{where: report.residual_structure.where, mark: 'rest'}] : [])].forEach((effect, i) => {
        const w = effect.where;
        if (!present(w.s_from) && !present(w.s_to)) return;
        const from = 1e3 * (w.s_from || 0), to = present(w.s_to) ? 1e3 * w.s_to : last;
        shapes.push({type: 'rect', xref: 'x' + n, yref: 'paper', x0: from - 0.02 * last, x1: to + 0.02 * last, y0: 0, y1: 1, fillcolor: '#000', opacity: 0.1, line: {width: 0}, layer: 'below'});
        notes.push({text: effect.mark || String(i + 1), xref: 'x' + n, yref: 'paper', x: from, y: 0.99 - 0.1 * i, yanchor: 'top', showarrow: false, font: {size: 15},
          bordercolor: ink, borderpad: 2, bgcolor: '#fff'});
      });
      notes.push({text: narrow ? inLines(head, 13) : head, xref: 'x' + n + ' domain', yref: 'paper', x: 0.5, y: 1.0, yanchor: 'bottom', showarrow: false, font: {size: font.size}});
    });
    // In a narrow window a label at the end would run into the next panel's first.
    const places = narrow ? {tickvals: [0, Number((0.5 * last).toPrecision(1))], range: [-0.12 * last, 1.14 * last]} : {range: [-0.05 * last, 1.06 * last]};
    const s = () => axis('s / mm', Object.assign({zeroline: false}, places));
    draw(place, traces, layout(430, {shapes, annotations: notes, margin: {l: 70, r: 20, t: 76, b: 60}, legend: {orientation: 'h', x: 0, y: 1.1, yanchor: 'bottom'},
      grid: {rows: 1, columns: 3, pattern: 'independent', xgap: 0.08},
      xaxis: s(), xaxis2: s(), xaxis3: s(), yaxis: axis((mean ? 'mean' : 'rms') + ' residual / mm', {rangemode: mean ? 'normal' : 'tozero'}),
      yaxis2: axis('', {matches: 'y', showticklabels: false}), yaxis3: axis('', {matches: 'y', showticklabels: false})}));
  };
  const kinds = a.mean_before[0].length === a.s.length ? choice('residual', ['root mean square', 'mean (measured − modelled)'], i => { mean = i === 1; show(); }) : null;
  const placed = where => present(where.s_from) || present(where.s_to);
  const bands = report.effects.some(effect => placed(effect.where)) || (restSits() && placed(report.residual_structure.where));
  return {nodes: [element('div', {class: 'controls'}, kinds), bands ? element('p', {class: 'hint'}, 'Shaded: where the effects (by their numbers) and what is left (rest) sit.') : null, place], draw: show};
}

// --- Trials and estimates -------------------------------------------------------------------------------------------

function heldOut() {
  const trials = data.trials.filter(trial => trial.mean_before > 0);
  if (!trials.length) return null;
  const place = plotPlace('mean error of each trial, predicted from the others, before and after');
  const show = () => {
    const y = trials.map((_, i) => i);
    const traces = phases.length < 2 ? [] : [{type: 'scatter', mode: 'lines', showlegend: false, hoverinfo: 'skip', line: {color: '#555', width: 2},
      x: trials.flatMap(t => [1e3 * t.mean_before, 1e3 * t.mean_after, null]), y: trials.flatMap((_, i) => [i, i, null])}];
    phases.forEach(phase => traces.push(phaseLine(phase, {mode: 'markers', x: trials.map(t => 1e3 * t['mean_' + phase]), y, text: trials.map(t => plain(t.name)),
      hovertemplate: '%{text}: %{x:.2f} mm', marker: {color: looks[phase].color, symbol: looks[phase].symbol, size: 14, line: {width: 3, color: looks[phase].color}}})));
    const levels = [];
    const widest = Math.max(...trials.flatMap(t => [t.mean_before, t.mean_after || 0]));
    const crowded = meanNoise() < 0.15 * widest;  // its words would leave the plot
    if (report.noise_floor_m > 0) levels.push(level(1e3 * meanNoise(), '\u00a0measurement noise alone (dotted)\u00a0', 'dot', true, crowded ? 'left' : 'right'));
    if (narrow && levels.length) Object.assign(levels[0].note, {text: 'dotted: measurement noise alone', xref: 'paper', x: 0, xanchor: 'left', font: {size: font.size}});
    const height = 34 * trials.length;  // of the plot itself
    draw(place, traces, layout(height + 150, {shapes: levels.map(one => one.shape), annotations: levels.map(one => one.note), margin: {l: 70, r: 20, t: 90, b: 60},
      legend: {orientation: 'h', x: 1, xanchor: 'right', y: 1 + 30 / height, yanchor: 'bottom'},  // above the words of the line
      xaxis: axis('mean error of a body, of each trial by a model fitted to the others / mm', {rangemode: 'tozero'}),
      yaxis: axis('', {tickvals: y, ticktext: trials.map(t => beside(t.name)), autorange: 'reversed', zeroline: false})}));
  };
  return {nodes: [report.improvement ? element('p', null, report.improvement) : null, place], draw: show};
}

function shifts() {
  if (!report.shifts.length || !anyEffect) return null;
  // What is not identifiable has bars that would hide the others; the table has it.
  const identifiable = one => 2 * (one.sd_after || 0) < Math.abs(one.after) && 2 * (one.sd_before || 0) < Math.abs(one.after);
  const rows = report.shifts.filter(one => one.after && identifiable(one));
  const place = plotPlace('estimates before, in percent of those with the effects in the model');
  const show = () => {
    const y = rows.map((_, i) => i);
    const traces = phases.map(phase => phaseLine(phase, {mode: 'markers', y: y.map(i => i + (phase === 'before' ? -0.13 : 0.13)),
      x: rows.map(one => 100 * (one[phase] - one.after) / Math.abs(one.after)), text: rows.map(one => plain(one.name)), hovertemplate: '%{text}: %{x:+.1f} %',
      error_x: {type: 'data', array: rows.map(one => 100 * 1.645 * one['sd_' + phase] / Math.abs(one.after)), color: looks[phase].color, thickness: 3, width: 7}}));
    draw(place, traces, layout(130 + (narrow ? 58 : 48) * rows.length, {xaxis: axis('off the estimate with the effects in the model / %', {nticks: narrow ? 4 : 0, zerolinewidth: 2, zerolinecolor: ink}),
      yaxis: axis('', {tickvals: y, ticktext: rows.map(one => beside(one.name)), autorange: 'reversed', zeroline: false})}));
  };
  return {nodes: [rows.length ? place : null, shiftsTable(), element('p', {class: 'hint'}, '± and bars: 90 % intervals.' +
    (rows.length < report.shifts.length ? ' Not in the plot: what these trials do not identify to 50 %.' : ''))], draw: rows.length ? show : null};
}
