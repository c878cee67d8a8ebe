'use strict';
// Puts the page together: a section that has nothing to show is left out, one that fails says so and leaves the others be.

const withPlots = typeof Plotly !== 'undefined';

/// A section's parts: nodes, and for plots what draws them once they are on the page.
const sections = [
  ['effects', 'Cause', report.verdict === 'unknown' ? 'What helps, without being the whole explanation' : 'What was left out of the model', effects],
  ['small', 'Small', 'Small departures, as every arm has them', smallDepartures],
  ['stand-ins', 'Stand-ins', 'In the model too, and likely to stand in for something else', standIns],
  ['law', 'Learnt', 'A law that was learnt from what is left', discoveredLaw],
  ['next', 'Next', 'What to measure next', nextExperiment],
  ['held-out', 'Unseen trials', phases.length > 1 ? 'How much better on unseen trials' : 'On unseen trials', heldOut],
  ['shifts', 'Estimates', 'Estimates, before and with this in the model', shifts],
  ['tip', 'Tip', 'The tip, measured and predicted', tipLoop, true],
  ['arm', 'Arm', phases.length > 1 ? 'The arm, before and after' : 'The arm, measured and modelled', arm, true],
  ['along', 'Along s', 'Where along the arm', along, true],
  ['time', 'In time', 'When', inTime, true],
  ['inputs', 'Inputs', 'With which input', againstInputs, true],
  ['ranking', 'Candidates', 'All candidates', ranking],
  ['ladder', 'One arm?', 'One arm or many?', ladder],
  ['parameter_variation', 'Drift', 'Parameters that drift', parameterVariation, true],
  ['left', 'Left over', 'What is left', leftOver],
  ['trials', 'Trials', 'Each trial', trialsTable],
  ['go-on', 'Go on', 'Go on with it', goOn],
  ['notes', 'Notes', 'Notes', notes],
  ['origin', 'Origin', 'How this page was made', origin],
];

function failed(what, error) {
  errors.push(what + ': ' + (error && error.stack || error));
  return element('p', {class: 'warning'}, 'This part could not be shown (' + (error && error.message || error) + ').');
}
window.addEventListener('error', event => errors.push(String(event.message)));
window.addEventListener('unhandledrejection', event => errors.push(String(event.reason)));

function build() {
  const page = document.getElementById('page'), links = element('nav', {'aria-label': 'parts'}), later = [];
  page.append(header());
  if (!withPlots) {
    page.append(element('p', {class: 'warning'}, 'Without plots: plotly.min.js was not found when this page was written. The sentences and tables are complete; ' +
      'on Debian, apt-get install python3-plotly and repeat the diagnosis to have the plots.'));
  }
  page.append(links);
  for (const [id, link, title, make, onlyPlot] of sections) {
    if (onlyPlot && !withPlots) continue;
    let made;
    try { made = make(); } catch (error) { made = [failed(title, error)]; }
    if (!made) continue;
    const nodes = Array.isArray(made) ? made : made.nodes;
    const section = element('section', {id, class: made.draw ? 'whole' : 'text'}, element('h2', null, title), nodes.filter(node => withPlots || !(node instanceof Element && node.classList.contains('picture'))));
    page.append(section);
    links.append(element('a', {href: '#' + id}, link));
    if (made.draw && withPlots) later.push([title, section, made.draw]);
  }
  // On the page first: a plot takes its width from its place.
  for (const [title, section, show] of later) {
    try { show(); } catch (error) { section.append(failed(title, error)); }
  }
}

/// Paper is narrower than the window, and a browser prints plots as they are.
function forPaper(paper) {
  document.querySelectorAll('details').forEach(details => { if (paper) details.dataset.was = details.open ? 'yes' : ''; details.open = paper || details.dataset.was === 'yes'; });
  drawn.filter(place => place.isConnected && place.layout).forEach(place => {
    const width = isSmall(place) ? 430 : 900;
    const size = paper ? {width, autosize: false} : {width: null, autosize: true};
    Plotly.relayout(place, size).then(() => Plotly.relayout(place, size));  // the first one places the legend by the old width
  });
}

build();
if (withPlots) {
  window.addEventListener('beforeprint', () => forPaper(true));
  window.addEventListener('afterprint', () => forPaper(false));
}
// For who tests the page: what was drawn, and what went wrong.
setTimeout(() => {
  document.documentElement.dataset.plots = String(document.querySelectorAll('.picture .main-svg').length > 0 ? drawn.length : 0);
  document.documentElement.dataset.errors = errors.join(' | ');
}, 0);
