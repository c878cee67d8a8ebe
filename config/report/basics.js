'use strict';
// Elements, numbers and names. Everything that came out of bags and files passes through text nodes (element()) or, in
// plots, through plain(): nowhere is it taken for HTML.

const data = JSON.parse(document.getElementById('data').textContent);

const errors = [];

/// element('p', {class: 'lead'}, 'text', child, ...); null children are left out.
function element(tag, attributes, ...children) {
  const made = tag === 'svg' || svgTags.has(tag) ? document.createElementNS('http://www.w3.org/2000/svg', tag)
                                                 : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) made.setAttribute(name, value);
  for (const child of children.flat()) {
    if (child === null || child === undefined || child === '') continue;
    made.append(child instanceof Node ? child : String(child));
  }
  return made;
}
const svgTags = new Set(['line', 'rect', 'circle', 'text', 'path', 'g']);

/// For Plotly, which takes <b>, <a> and entities in its texts for markup, and %{...} for a place to fill in. Between marks
/// that keep a name written from right to left from turning what stands beside it.
function plain(text) {
  return '\u2068' + String(text).replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;').replace(/%\{/g, '%\u200b{') + '\u2069';
}

/// A name out of a bag or file, whichever way it is written.
function named(text) { return element('bdi', null, text); }

/// Shortens long names of files for an axis; the tables have them whole.
function short(name, most = 28) {
  const text = String(name);
  return text.length <= most ? text : text.slice(0, most - 9) + '…' + text.slice(-8);
}

function present(value) { return value !== null && value !== undefined; }

/// {shown: 'kPa', scale: 1e-3} for 'Pa'.
function shownUnit(unit) {
  const found = data.units.find(one => one.unit === unit);
  if (found) return found;
  const nothing = !unit || unit === '1' || unit === '-';
  return {shown: nothing ? '' : unit.replace(/\^2/g, '²').replace(/\^3/g, '³').replace(/ /g, '\u00a0'), scale: 1};
}

function withUnit(name, unit) {
  const shown = shownUnit(unit).shown;
  return shown ? name + ' / ' + shown : name;
}

function scaled(values, scale) { return values.map(value => present(value) ? scale * value : null); }

function raised(power) { return String(power).replace(/[-0-9]/g, sign => sign === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[sign]); }

/// "0.0379 ± 0.0010": as many digits as the second is worth.
function plusMinus(value, half) {
  const most = Math.max(Math.abs(value), half), size = most > 0 ? Math.floor(Math.log10(most)) : 0;
  const power = size < -4 || size > 5 ? size : 0, v = value / 10 ** power, h = half / 10 ** power;
  const places = h > 0 ? Math.min(8, Math.max(0, 1 - Math.floor(Math.log10(h)))) : 4;
  const text = v.toFixed(places).replace('-', '−') + ' ± ' + h.toFixed(places);
  return power ? '(' + text + ')·10' + raised(power) : text;
}

function digits(value, significant) {
  if (!present(value)) return '–';
  if (value === 0) return '0';
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -4 || size > 5) return (value / 10 ** size).toFixed(significant - 1).replace('-', '−') + '·10' + raised(size);
  return value.toFixed(Math.max(0, significant - 1 - size)).replace('-', '−');
}

function mm(metres) { return present(metres) ? (1e3 * metres).toFixed(2) + '\u00a0mm' : '–'; }

function percent(share) {
  if (!present(share)) return '–';
  return share > 0.99 && share <= 1 ? '>\u00a099\u00a0%' : share < 0.01 && share >= 0 ? '<\u00a01\u00a0%' : Math.round(100 * share) + '\u00a0%';
}

function pValue(p) { return !present(p) ? '–' : p < 1e-4 ? '< 0.0001' : p.toPrecision(2); }

/// "a, b or c" as nodes, each name in <code>.
function names(list) {
  return list.flatMap((name, i) => [i === 0 ? '' : i + 1 === list.length ? ' or ' : ', ', element('code', null, named(name))]);
}

/// A source with its link. Nothing but an identifier becomes part of an address.
function cited(source) {
  const found = /\b(doi|isbn):(10\.\d{4,}\/[-\w.()\/]+|\d{9}[\dX])$/.exec(source);
  if (!found) return [source];
  const address = (found[1] === 'doi' ? 'https://doi.org/' : 'https://openlibrary.org/isbn/') + found[2];
  return [source.slice(0, found.index), element('a', {href: address, rel: 'noopener noreferrer'}, found[0])];
}

/// rows of cells; a cell is a text, nodes, {number: text} or {share: nodes}.
function table(heads, rows, rowClass) {
  const kindOf = content => ['number', 'share'].find(kind => content !== null && typeof content === 'object' && kind in content);
  const cell = (tag, content, i) => {
    const kind = kindOf(content), attributes = kind ? {class: kind} : {}, inner = kind ? content[kind] : content;
    if (tag === 'th') return element(tag, attributes, inner);
    // In a narrow window each row is a list of its own, and each cell says of what.
    const head = kindOf(heads[i]) ? heads[i][kindOf(heads[i])] : heads[i];
    return element(tag, {...attributes, 'data-head': String(head || '')}, element('div', null, inner));
  };
  return element('div', {class: 'scroll'}, element('table', null,
    element('thead', null, element('tr', null, heads.map(head => cell('th', head)))),
    element('tbody', null, rows.map((row, i) =>
      element('tr', rowClass ? {class: rowClass(i)} : null, row.map((content, i) => cell('td', content, i)))))));
}

/// A labelled list to choose from; `chosen` is called with the index.
function choice(label, options, chosen, first = 0) {
  const list = element('select', null, options.map((name, i) => element('option', {value: i, dir: 'auto', ...(i === first ? {selected: ''} : {})}, name)));
  list.addEventListener('change', () => chosen(list.selectedIndex));
  return element('label', null, label, list);
}

/// Root mean square of what is there; null if nothing is.
function rms(values) {
  const there = values.filter(present);
  return there.length ? Math.sqrt(there.reduce((sum, v) => sum + v * v, 0) / there.length) : null;
}
