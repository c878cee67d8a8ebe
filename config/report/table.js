'use strict';
// A page of one table: sorted by a click on a heading, searched by words.

const page = document.getElementById('page');
const state = {column: -1, up: true, words: ''};

/// Only what lies beside the page: an address of its own is not followed.
function linked(cell) {
  const shown = named(cell.text);
  return /^[\w.][\w.\-/]*$/.test(cell.link || '') ? element('a', {href: cell.link}, shown) : shown;
}

function contentOf(cell, column) {
  const inner = cell.link ? linked(cell) : named(cell.text);
  if (column.numbers) return {number: inner};
  const kind = column.wide ? 'name wide' : cell.text.length > 14 ? 'name' : '';  // a word is as wide as it is
  return element('span', {class: kind}, inner);
}

/// Absent values come last, whichever way it goes.
function compare(a, b) {
  const left = a.cells[state.column], right = b.cells[state.column];
  if (data.columns[state.column].numbers) {
    if (!present(left.number) || !present(right.number)) return present(right.number) - present(left.number);
    return (state.up ? 1 : -1) * (left.number - right.number);
  }
  if (!left.text || !right.text) return (right.text ? 1 : 0) - (left.text ? 1 : 0);
  return (state.up ? 1 : -1) * left.text.localeCompare(right.text, undefined, {numeric: true});
}

function chosenRows() {
  const words = state.words.toLowerCase().split(/\s+/).filter(word => word);
  const rows = data.rows.filter(row => {
    const text = row.cells.map(cell => cell.text).join(' ').toLowerCase();
    return words.every(word => text.includes(word));
  });
  return state.column < 0 ? rows : rows.sort(compare);
}

function sortBy(column) {
  state.up = state.column === column ? !state.up : true;
  state.column = column;
  draw();
}

const place = element('div', {id: 'table'});
const count = element('span', {class: 'hint'});

function draw() {
  const rows = chosenRows();
  const made = table(data.columns.map(column => column.numbers ? {number: column.heading} : column.heading),
                     rows.map(row => row.cells.map((cell, i) => contentOf(cell, data.columns[i]))),
                     i => rows[i].marked ? 'present' : '');
  made.querySelectorAll('thead th').forEach((head, i) => {
    const button = element('button', {type: 'button', class: 'sort'}, ...head.childNodes);
    if (i === state.column) {
      head.setAttribute('aria-sort', state.up ? 'ascending' : 'descending');
      button.append(state.up ? ' ↑' : ' ↓');
    }
    button.addEventListener('click', () => sortBy(i));
    head.replaceChildren(button);
  });
  place.replaceChildren(made);
  count.textContent = rows.length === data.rows.length ? rows.length + ' jobs' : rows.length + ' of ' + data.rows.length + ' jobs';
}

function chooser() {
  const words = element('input', {type: 'search', placeholder: 'words that a row must have', 'aria-label': 'words that a row must have'});
  words.addEventListener('input', () => { state.words = words.value; draw(); });
  const order = element('select', {'aria-label': 'sorted by'}, element('option', {value: -1}, 'as listed'),
                        data.columns.map((column, i) => element('option', {value: i}, column.heading)));
  order.addEventListener('change', () => { state.column = Number(order.value); state.up = true; draw(); });
  return element('div', {class: 'controls'}, words, element('label', {class: 'narrow'}, 'sorted by', order), count);
}

page.append(
  element('p', {class: 'kicker'}, named(data.kicker)),
  element('div', {class: 'title'}, element('h1', null, data.title),
          element('span', {class: 'verdict ' + (data.whole ? 'explained' : 'unknown')}, data.verdict)),
  element('div', {class: 'figures'}, data.figures.map(([value, meaning]) =>
    element('div', {class: 'figure'}, element('b', null, value), element('span', null, meaning)))),
  chooser(), place, ...data.notes.map(note => element('p', {class: 'hint'}, note)));
draw();
