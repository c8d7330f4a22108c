'use strict';
// What the pages share: elements, words, charts and tables. Whatever comes from data goes in as text or as an attribute, never as markup.

/** A number and its unit stay on one line. */
const joined = (text) => text.replace(/(\d) (%|px|mm|mrad|N m|s)(?![a-z])/g, '$1\u00a0$2');

/** An element with attributes and children; strings become text. */
function el(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) node.setAttribute(name, value);
  for (const child of children.flat()) {
    if (child !== null && child !== undefined) node.append(child);
  }
  return node;
}

/** A number with three significant digits as people write it. */
function figure(value, digits = 3) {
  if (value === null || value === undefined || !isFinite(value)) return 'not known';
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    const raised = String(Number(exponent)).replace(/[-0-9]/g, (c) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(c)]);
    return mantissa.replace('-', '−') + ' · 10' + raised;
  }
  const decimals = size === 0 ? 0 : Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toFixed(Math.min(decimals, 6)).replace('-', '−');
}

/** Figures of one column with the same number of decimals. */
function fixed(value, decimals = 3) {
  return value === null || value === undefined || !isFinite(value) ? '–' : value.toFixed(decimals).replace('-', '−');
}

const percent = (share) => Math.round(100 * share) + ' %';
const place = (location) => location.replace(/^(joint|link):/, '$1 ');

/** A section of the page with its entry in the contents. */
function section(id, title, shortTitle) {
  const node = el('section', {id, 'aria-labelledby': id + '-title'}, el('h2', {id: id + '-title'}, title));
  document.getElementById('main').append(node);
  document.getElementById('contents').append(el('li', {}, el('a', {href: '#' + id}, shortTitle || title)));
  return node;
}

/** The one line that says what good looks like. */
function good(text) {
  return el('p', {class: 'good'}, el('b', {}, 'Good: '), text);
}

const charts = [];

/**
 * A figure with an SVG of fixed inner size.
 * @param words  what it shows, for those who do not see it.
 * @param draw   called with a D3 selection of the SVG; may be called again.
 */
function chart(parent, {id, width, height, words, caption, draw, role}) {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  svg.setAttribute('role', role || 'img');
  svg.setAttribute('aria-label', words);
  svg.id = 'chart-' + id;
  const box = el('figure', {}, svg);
  if (caption) box.append(el('figcaption', {}, caption));
  parent.append(box);
  const entry = {id, svg, redraw: () => {
    d3.select(svg).selectAll('*').remove();
    draw(d3.select(svg));
  }};
  charts.push(entry);
  return entry;
}

/** Draws all; what fails is told, and does not keep the others from being drawn. */
function drawCharts() {
  const drawn = [];
  for (const entry of charts) {
    try {
      entry.redraw();
      if (entry.svg.childElementCount > 0) drawn.push(entry.id);
    } catch (problem) {
      console.error('chart ' + entry.id + ': ' + problem.message);
    }
  }
  document.documentElement.dataset.charts = charts.map((entry) => entry.id).join(' ');
  document.documentElement.dataset.drawn = drawn.join(' ');
}

/** A table from rows of strings; columns whose name starts with "#" are aligned as numbers. */
function table(caption, columns, rows) {
  const number = columns.map((name) => name.startsWith('#'));
  const cell = (tag, content, k) => el(tag, Object.assign(number[k] ? {class: 'number'} : {}, tag === 'th' ? {scope: 'col'} : {}), content);
  return el('div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': caption},
      el('table', {}, el('caption', {}, caption),
          el('thead', {}, el('tr', {}, columns.map((name, k) => cell('th', name.replace(/^#/, ''), k)))),
          el('tbody', {}, rows.map((row) => el('tr', {}, row.map((content, k) => cell('td', content, k)))))));
}

/** An axis below or at the left, in muted ink. */
function axisBelow(svg, scale, y, count, format) {
  svg.append('g').attr('transform', `translate(0,${y})`).call(d3.axisBottom(scale).ticks(count, format).tickSize(4));
}
function axisLeft(svg, scale, x, count, format) {
  svg.append('g').attr('transform', `translate(${x},0)`).call(d3.axisLeft(scale).ticks(count, format).tickSize(4));
}

function startTheme() {
  const button = document.getElementById('theme');
  const prefersDark = window.matchMedia('(prefers-color-scheme: dark)');
  const show = (dark) => {
    document.documentElement.dataset.theme = dark ? 'dark' : 'light';
    button.setAttribute('aria-pressed', String(dark));
  };
  show(prefersDark.matches);
  prefersDark.addEventListener('change', (event) => show(event.matches));
  button.addEventListener('click', () => show(document.documentElement.dataset.theme !== 'dark'));
}

window.addEventListener('beforeprint', () => {
  for (const details of document.querySelectorAll('main details')) details.open = true;
});
