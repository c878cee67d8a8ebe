'use strict';
// The parts of the page that are text and tables. Each returns a list of nodes, or null where there is nothing to say.

const report = data.report;
/// Whether there is an "after".
const anyEffect = report.effects.length + report.small_departures.length + report.stand_ins.length > 0;

function header() {
  const baseline = report.baseline, extended = report.extended;
  const figure = (value, words) => element('div', {class: 'figure'}, element('b', null, value), element('span', null, words));
  // What a range that is too narrow makes effects stand in for is no improvement.
  const same = !anyEffect || report.narrow_range || baseline.held_out_mean_m === extended.held_out_mean_m;
  const measured = baseline.held_out_mean_m > 0;
  const beforeAfter = key => same ? mm(baseline[key]) : mm(baseline[key]).slice(0, -3) + ' → ' + mm(extended[key]);
  const ofLength = report.length_m > 0 ? ' (' + (100 * (same ? baseline : extended).held_out_mean_m / report.length_m).toPrecision(2) + ' % of the length)' : '';
  return element('header', null,
    element('p', {class: 'kicker'}, 'Model against recordings: ', named(report.arm), report.version ? ' · softarm ' + report.version : '', report.origin ? ' · ' + report.origin.date : ''),
    element('div', {class: 'title'}, element('h1', null, report.headline),
      element('span', {class: 'verdict ' + report.verdict}, report.verdict.replace('_', ' ') + (report.told_payloads ? ' with other payloads' : ''))),
    report.summary ? element('p', {class: 'lead'}, report.summary) : null,
    restSits() ? element('p', {class: 'lead'}, 'What is left sits ' + report.residual_structure.place + '.') : null,
    element('div', {class: 'figures'},
      measured ? figure(beforeAfter('held_out_mean_m'), 'mean error of a body on unseen trials' + (same ? '' : ', before → after') + ofLength) : null,
      measured ? figure(beforeAfter('held_out_max_m'), 'the largest') : null,
      report.noise_floor_m > 0 ? figure(mm(meanNoise()), 'measurement noise alone: the mean error that it makes') : null,
      present(report.ceiling_rms_m) ? figure(mm(report.ceiling_rms_m), 'rms weighted by precision that a flexible model of the residuals reaches (ceiling); the model: ' + beforeAfter('held_out_weighted_rms_m')) : null,
      present(report.ceiling_rms_m) && !same ? figure(percent(report.explained_share), 'of what could be explained is explained') : null));
}

/// Mean distance of a body that noise alone makes: of three equal normal coordinates.
function meanNoise() {
  return Math.sqrt(8 / (3 * Math.PI)) * report.noise_floor_m;
}

/// Whether there is something left that has a place: not where all is explained.
function restSits() {
  return report.residual_structure.place !== '' && ['unknown', 'partly_explained', 'cannot_tell'].includes(report.verdict);
}

/// The arm from base to tip, with the bodies and the stretch that an effect sits on.
function strip(where) {
  const s = data.along.s, length = Math.max(...s, where.s_to || 0, where.s_from || 0);
  if (!s.length || !(length > 0) || !(present(where.s_from) || present(where.s_to))) return null;
  const width = narrow ? 380 : 760, x = at => 40 + (width - 100) * at / length;  // not smaller type in a narrow window
  const from = x(where.s_from || 0), to = x(present(where.s_to) ? where.s_to : length);
  const text = (at, words, anchor) => element('text', {x: at, y: 56, 'text-anchor': anchor, 'font-size': 15, fill: '#111'}, words);
  return element('svg', {viewBox: '0 0 ' + width + ' 64', class: 'strip', role: 'img',
      'aria-label': 'place along the arm: ' + Math.round(1e3 * (where.s_from || 0)) + ' to ' + Math.round(1e3 * (present(where.s_to) ? where.s_to : length)) + ' mm of ' + Math.round(1e3 * length) + ' mm'},
    element('line', {x1: x(0), y1: 22, x2: x(length), y2: 22, stroke: '#111', 'stroke-width': 3}),
    element('rect', {x: Math.min(from - 4, width), y: 9, width: Math.max(8, to - from + 8), height: 26, fill: '#111', 'fill-opacity': 0.28, stroke: '#111', 'stroke-width': 2}),
    s.map(at => element('circle', {cx: x(at), cy: 22, r: 5, fill: '#fff', stroke: '#111', 'stroke-width': 2})),
    text(x(0), 'base', 'middle'), text(x(length), 'tip, ' + Math.round(1e3 * length) + ' mm', 'middle'));
}

function effects() {
  if (!report.effects.length) return null;
  return report.effects.map((effect, i) => element('div', {class: 'effect'},
    element('h3', null, (i + 1) + '. ' + (effect.description || effect.name) + ' ', element('code', null, effect.name)),
    effect.said ? element('p', null, effect.sentence) : null,
    element('dl', null,
      effect.sizes.flatMap(([label, size]) => [element('dt', null, 'how large'), element('dd', null, label + ': ', element('b', null, size))]),
      effect.law ? [element('dt', null, 'law'), element('dd', null, element('span', {class: 'law'}, equation(effect.law)))] : null,
      effect.source ? [element('dt', null, 'source'), element('dd', null, cited(effect.source))] : null,
      effect.place ? [element('dt', null, 'where'), element('dd', null, effect.place)] : null,
      element('dt', null, 'how sure'), element('dd', null, element('b', null, effect.sure)),
      element('dt', null, 'easily mistaken for'),
      element('dd', null, effect.confusable_with.length ? names(effect.confusable_with) : 'nothing that these recordings leave open'),
      present(effect.held_out_gain) ? [element('dt', null, 'on unseen trials'),
        element('dd', null, mm(Math.abs(effect.held_out_gain)) + (effect.held_out_gain < 0 ? ' more' : ' less') + ' rms error with it in the model')] : null),
    strip(effect.where)));
}

/// Powers and Greek letters as they are printed.
function equation(text) {
  return text.replace(/\^(\d)/g, (_, power) => raised(power)).replace(/ - /g, ' − ').replace(/(^|[( ])-(?=\d)/g, '$1−').replace(/-(share|mu)\b/g, '−$1')
    .replace(/\bbeta\b/g, 'β').replace(/\bmu\b/g, 'μ').replace(/\btheta\b/g, 'θ').replace(/\brho\b/g, 'ρ');
}

/// A text that is there to be taken away, with a button that does.
function toCopy(text, what, folded) {
  const words = element('pre', {class: 'copy', tabindex: '0'}, text), done = element('span', {'aria-live': 'polite'});
  const button = element('button', {type: 'button'}, 'copy ' + what);
  button.addEventListener('click', () => {
    const chosen = () => { getSelection().selectAllChildren(words); return document.execCommand('copy'); };  // a page out of a file may have no clipboard
    const say = copied => { done.textContent = copied ? ' copied' : ' not copied: select it and copy it by hand'; };
    if (navigator.clipboard) navigator.clipboard.writeText(text).then(() => say(true), () => say(chosen()));
    else say(chosen());
  });
  const controls = element('div', {class: 'controls copying'}, button, done);
  return folded ? [controls, element('details', null, element('summary', null, folded), words)] : [words, controls];
}

/// The arm file with what was found in it, and how to use it.
function goOn() {
  if (!report.extended_text || !(anyEffect || report.discovered_law)) return null;
  return [report.next_command ? [element('p', {class: 'leads-in'}, 'The first trial once more, with this in the model:'), toCopy(report.next_command, 'the command')] : null,
    element('p', null, 'arm_extended.yaml is the arm file with the constants and effects found. ' + (report.verdict === 'unknown' ?
      'It does not hold the whole explanation: the node says so when it loads it.' : 'Programs and nodes take it in place of the arm file.')),
    toCopy(report.extended_text, 'arm_extended.yaml', 'arm_extended.yaml')].flat(2);
}

/// What every arm has, or what hardly is there: a line each.
const smallDepartures = () => lines(report.small_departures);
const standIns = () => lines(report.stand_ins);
function lines(list) {
  if (!list.length) return null;
  return [element('ul', null, list.map(effect => element('li', null, element('code', null, effect.name), ' ', effect.sentence)))];
}

/// Each term as an equation with where such equations are from; then where the way to find it is from.
function lawEquations(law) {
  const line = (head, ...content) => [element('dt', null, head), element('dd', null, ...content)];
  const lines = law.terms.flatMap((term, i) => [
    ...(term.equation ? line('law' + (law.terms.length > 1 ? ', term ' + (i + 1) : ''), element('span', {class: 'law'}, equation(term.equation)), '; ', named(term.symbols)) : []),
    ...(term.source && (law.terms[i + 1] || {}).source !== term.source ? line('source', ...cited(term.source)) : [])]);
  const method = law.source ? line('method', ...cited(law.source)) : [];
  return lines.length + method.length ? element('div', {class: 'effect'}, element('dl', null, lines, method)) : null;
}

/// No name: what the rest goes with, as moments that the extended arm file has.
function discoveredLaw() {
  const law = report.discovered_law;
  if (!law) return null;
  const before = law.held_out_mean_before_m, after = law.held_out_mean_after_m;
  const row = term => [[element('b', null, named(term.goes_with)), element('small', null, equation('learnt between ' + term.range[0] + ' and ' + term.range[1]))],
    [(term.has_direction ? 'along it: ' : 'towards x: ') + term.sizes[0]], [(term.has_direction ? 'across it: ' : 'towards y: ') + term.sizes[1]],
    term.rises ? 'at the tip; the opposite at the base' : 'the same all along', {share: [bar(term.stability, ''), term.sure]}];
  return [element('p', {class: 'lead'}, law.sentence),
    lawEquations(law),
    element('p', {class: 'hint'}, 'M bends a section towards x and y' + (law.terms.length > 1 ? '; the terms add up' : '') + '. Sizes with 90 % intervals:'),
    table(['a moment that goes with', 'at the end of that range', 'and', 'along the arm', 'chosen by'], law.terms.map(row)),
    element('p', {class: 'hint'}, 'Chosen by: the share of halves of the trials in which this moment, or one that stands for it, is among those that explain most. ' +
      'The law was tried on ' + law.sequences + ' input sequences, each predicted by refits to the others, with the moments chosen anew: mean error ' +
      mm(before) + ' → ' + mm(after) + ', at most ' + mm(law.held_out_max_before_m) + ' → ' + mm(law.held_out_max_after_m) +
      '. It is in arm_extended.yaml as learned_moment, but is not part of the verdict: a learnt law is not a cause.')];
}

function nextExperiment() {
  const next = report.next_experiment;
  if (!next) return null;
  return [element('div', {class: 'next'},
    element('p', {class: 'lead'}, next.action.replace(/\.?$/, '.')),
    next.sentence ? element('p', null, next.sentence) :
    next.separates.length ? element('p', null, 'It would separate ', names(next.separates),
      next.expected_separation > 0 ? ', by about ' + next.expected_separation.toFixed(1) + ' standard deviations.' : '.') : null),
    experimentMenu(next)];
}

/// What else could be done, and how well it would separate them.
function experimentMenu(next) {
  const menu = next.menu || [];
  if (!menu.length) return null;
  const light = menu.some(one => (one.shows || []).length), most = Math.max(...menu.map(one => light ? (one.shows || []).length : one.separation));
  const gain = one => light ? String((one.shows || []).length) : one.separation.toFixed(one.separation < 10 ? 1 : 0);
  const share = one => most > 0 ? (light ? (one.shows || []).length : one.separation) / most : 0;
  const pair = !light && next.separates.length === 2;
  const last = one => light ? (one.shows && one.shows.length ? names(one.shows) : '–') : one.hardest ? names(one.hardest) : '–';
  const heads = ['', light ? 'collinear effects that it brings to light' : 'separation / standard deviations', ...(pair ? [] : [light ? 'which' : 'hardest to separate'])];
  const part = list => table(heads, list.map(one => [one.action + '.', {share: [bar(share(one), ''), gain(one)]}, ...(pair ? [] : [last(one)])]));
  const first = 6;
  return element('div', null,
    light ? null : element('p', {class: 'hint'}, 'Each experiment is predicted with every rival, the constants refitted to the present trials and the new one. Separation is that of the pair it separates worst, ' +
      'whichever of the two is true; the present trials alone: ' + (next.today || 0).toFixed(1) + '.'),
    part(menu.slice(0, first)),
    menu.length > first ? element('details', null, element('summary', null, (menu.length - first) + ' more experiments that were considered'), part(menu.slice(first))) : null);
}

/// The same trials with fewer and fewer free numbers.
function ladder() {
  const made = report.ladder;
  if (!made || !made.rungs.length) return null;
  const most = Math.max(report.noise_floor_m, ...made.rungs.map(one => one.rms_m));
  const row = (words, unknowns, value, chi) => [words, {number: unknowns}, {share: [bar(most > 0 ? value / most : 0, ''), mm(value)]}, {number: chi.toFixed(2)}];
  return [made.sentence ? element('p', {class: 'lead'}, made.sentence) : null,
    table(['the model as it is, fitted to', {number: 'free numbers'}, 'rms error per body', {number: 'χ² per degree of freedom'}],
      [...made.rungs.map(one => row(one.description, String(one.unknowns), one.rms_m, one.chi2_per_dof)), row('measurement noise alone', '–', report.noise_floor_m, 1)]),
    element('p', {class: 'hint'}, 'Errors are corrected for the fitted numbers: the more of them are free, the more is added. What single instants explain and one arm does not ' +
      'hides in the variation of EI, M0, φ and L.')];
}

function bar(share, kind) {
  const inner = element('i');
  inner.style.width = Math.min(100, Math.max(0, 100 * share)) + '%';
  return element('span', {class: 'bar ' + kind, 'aria-hidden': 'true'}, inner);
}

function ranking() {
  if (!report.ranking.length) return null;
  const heads = ['', 'effect', 'probability', 'collinearity', {number: 'evidence (σ)'}, {number: 'rms effect'},
    {number: 'size found'}, {number: 'smallest size seen'}, 'finding'];
  const sizeOf = (one, value) => {
    const unit = shownUnit(one.unit || '');
    return present(value) ? [digits(unit.scale * value, 3), unit.shown ? element('small', null, unit.shown) : null] : '–';
  };
  const row = (one, i) => [String(i + 1), [element('code', null, one.name), element('small', null, one.description), one.source ? element('small', null, cited(one.source)) : null],
    {share: [bar(one.probability, ''), percent(one.probability)]}, {share: [bar(one.collinearity, 'absorbed'), percent(one.collinearity)]},
    {number: present(one.z) ? one.z.toFixed(1).replace('-', '−') : '–'}, {number: mm(one.size_m)},
    {number: sizeOf(one, one.estimate)}, {number: sizeOf(one, one.smallest_detectable)},
    one.meaning];
  const looked = report.ranking.filter(one => one.finding !== 'not_of_this_arm');
  const others = report.ranking.filter(one => one.finding === 'not_of_this_arm');
  const most = 8;
  const part = (from, to) => table(heads, looked.slice(from, to).map((one, i) => row(one, from + i)), i => looked[from + i].finding);
  return [
    element('p', {class: 'hint'}, 'Collinearity is the share of an effect’s signature that the arm’s own constants (EI, gains, length) absorb: ' +
      'the higher it is, the less a small residual proves. Evidence: by how many standard deviations the effect stands out from noise, before any other effect is fitted.'),
    part(0, most),
    looked.length > most ? element('details', null, element('summary', null, (looked.length - most) + ' more candidates'), part(most, looked.length)) : null,
    others.length ? element('p', {class: 'hint'}, 'Not applicable to this arm: ', others.map(one => one.description || one.name).join('; ') + '.') : null];
}

function leftOver() {
  const after = report.residual_structure, before = report.residual_structure_before;
  if (!(report.baseline.rms_m > 0)) return null;
  const inputs = [...new Set([...Object.keys(before.by_input_p), ...Object.keys(after.by_input_p)])];
  const own = (object, key) => Object.prototype.hasOwnProperty.call(object, key) ? object[key] : null;
  const judged = p => ({share: !present(p) ? '–' : pValue(p) + (p < 0.01 ? ' ▲ pattern' : ' no pattern')});
  const same = !anyEffect;
  const columns = (b, a) => same ? [b] : [b, a];
  const rows = [
    ['size of the residuals over that of the noise', ...columns(before, after).map(one => present(one.chi2_per_dof) ? Math.sqrt(one.chi2_per_dof).toFixed(2) : '–')],
    ['pattern in time, p', ...columns(judged(before.whiteness_p), judged(after.whiteness_p))],
    ['pattern along the arm, p', ...columns(judged(before.along_s_p), judged(after.along_s_p))],
    ...inputs.map(name => [[element('span', null, 'goes with '), named(name), ', p'], ...columns(judged(own(before.by_input_p, name)), judged(own(after.by_input_p, name)))]),
    ['where it sits', ...columns(before.place || '–', after.place || '–')]];
  return [table(['what is left of the residuals', ...(same ? ['model as it is'] : ['before', 'after'])], rows), restSits() ? strip(after.where) : null];
}

function shiftsTable() {
  const value = (v, sd, unit) => present(v) ? plusMinus(unit.scale * v, 1.645 * unit.scale * (sd || 0)) : '–';
  return table(['estimate', {number: 'before'}, {number: 'with the effects in the model'}, 'unit', {number: 'change'}],
    report.shifts.map(one => {
      const unit = shownUnit(one.unit);
      const change = one.before && one.after ? 100 * (one.after / one.before - 1) : null;
      return [element('span', {class: 'name'}, named(one.name)), {number: value(one.before, one.sd_before, unit)}, {number: value(one.after, one.sd_after, unit)}, unit.shown,
        {number: 2 * (one.sd_before || 0) > Math.abs(one.before) && 2 * (one.sd_after || 0) > Math.abs(one.after) ? 'not identifiable' : present(change) ? (change < 0 ? '−' : '+') + Math.abs(change).toFixed(1) + ' %' : '–'}];
    }));
}

function trialsTable() {
  if (!data.trials.length) return null;
  const worst = trial => trial.bodies.map(body => [body.name, rms(body.after || body.before)]).filter(one => present(one[1]))
    .sort((a, b) => b[1] - a[1])[0];
  return [table(['trial', {number: 'frames used'}, {number: 'length'}, {number: 'mean before'}, {number: 'mean after'}, {number: 'change'}, {number: 'largest before'}, {number: 'largest after'}, 'worst body after'],
    data.trials.map(trial => {
      const body = worst(trial), t = trial.t;
      return [element('span', {class: 'name'}, named(trial.name)), {number: String(trial.frames)}, {number: t.length ? (t[t.length - 1] - t[0]).toFixed(0) + ' s' : '–'},
        {number: mm(trial.mean_before)}, {number: mm(trial.mean_after)},
        {number: trial.mean_before > 0 && present(trial.mean_after) ? (100 * (trial.mean_after / trial.mean_before - 1)).toFixed(0).replace('-', '−') + ' %' : '–'},
        {number: mm(trial.max_before)}, {number: mm(trial.max_after)},
        body ? [named(body[0]), ', ' + mm(body[1])] : '–'];
    }))];
}

/// What it takes to make it again.
function origin() {
  const made = report.origin;
  if (!made) return null;
  return [element('p', {class: 'leads-in'}, 'On ' + made.date + (report.version ? ' by softarm ' + report.version : '') + ':'), ...toCopy(made.command, 'the command'),
    table(['file read', 'SHA-256'], made.files.map(file => [element('span', {class: 'name'}, named(file.name)), element('code', {class: 'digest'}, file.sha256)]))];
}

function notes() {
  return report.notes.length ? [element('ul', null, report.notes.map(note => element('li', null, note)))] : null;
}
