'use strict';
// Many captures in one table, each with a small picture of its errors.

const cells = JSON.parse(document.getElementById('data').textContent).cells;

/** The stages of a cell that have errors, and last the model with the findings. */
function stagesOf(cell) {
  const stages = cell.stages.slice();
  if (cell.diagnosed && cell.findings.length > 0) stages.push(Object.assign({found: true}, cell.diagnosed));
  return stages.filter((stage) => stage.mm !== null);
}

const best = (cell) => stagesOf(cell).slice(-1)[0] || null;

function cellWords(cell) {
  if (!cell.verdict) return cell.stages.length === 0 ? 'only registered, or without held-out poses' : 'not diagnosed';
  if (cell.why) return 'no diagnosis: ' + cell.why;
  if (cell.findings.length === 0) return cell.structure_left ? 'a gap, but no cause found' : 'nothing beyond noise and geometry';
  return cell.findings.map((f) => `${f.effect} at ${place(f.location)}` + (f.size ? ` (${f.size})` : '')).join('; ');
}

function shrinkageWords(cell) {
  const [value, low, high] = cell.shrinkage;
  return value === null ? '–' : `${percent(value)} (${percent(low)} to ${percent(high)})`;
}

function showFleet() {
  const found = cells.filter((cell) => cell.findings.length > 0).length, none = cells.filter((cell) => cell.verdict && !cell.why && cell.findings.length === 0).length;
  document.title = `${cells.length} captures – poecal fleet`;
  document.getElementById('about').textContent = `${cells.length} captures side by side`;
  const node = section('fleet', 'The fleet');
  node.querySelector('h2').replaceWith(el('h1', {id: 'fleet-title'}, `${cells.length} captures: ${found} with findings, ${none} with none, ${cells.length - found - none} without a diagnosis`));
  node.append(good('in every cell the points walk to the left, and the last points of all cells line up. A cell whose last point stays to the right is worth a look.'));
  const keys = [['before', 'nominal, registered'], ['after', 'identified'], ['diamond', 'with the findings']];
  node.append(el('p', {}, keys.map(([kind, text]) => el('span', {class: 'key'}, el('i', {class: kind, 'aria-hidden': 'true'}), text))));
  const order = el('select', {id: 'order'}, [['worst', 'largest error first'], ['name', 'by name'], ['given', 'as given']].map(([value, text]) => el('option', {value}, text)));
  node.append(el('div', {class: 'controls'}, el('label', {}, 'Order ', order)));
  const box = fleetTable();
  node.append(box);
  const body = box.querySelector('tbody'), rows = Array.from(body.children);
  const sort = () => {
    const key = {worst: (k) => -((best(cells[k]) || {mm: -1}).mm), name: (k) => cells[k].name, given: (k) => k}[order.value];
    d3.range(cells.length).sort((a, b) => d3.ascending(key(a), key(b)) || a - b).forEach((k) => body.append(rows[k]));
  };
  order.addEventListener('change', sort);
  sort();
}

function fleetTable() {
  const all = cells.flatMap((cell) => stagesOf(cell).map((stage) => stage.mm)).filter((mm) => mm > 0);
  const x = d3.scaleLog().domain(all.length > 0 ? [d3.min(all) / 1.3, d3.max(all) * 1.3] : [0.1, 10]).range([8, 252]);
  const rows = cells.map((cell, k) => {
    const last = best(cell);
    return [nameOf(cell), spark(cell, k, x), last ? fixed(last.mm) : '–', last ? fixed(last.mrad) : '–', last && last.px !== null ? fixed(last.px) : '–', cellWords(cell), shrinkageWords(cell), remarks(cell)];
  });
  return table('Errors on held-out poses; the chart shows the mean error of the flange in mm, the same logarithmic scale in every row', ['capture', 'mean error', '#mm', '#mrad', '#px rms', 'findings', 'gap closed', 'remarks'], rows);
}

function nameOf(cell) {
  if (cell.report === null) return cell.name;
  // Relative to this page, whatever the folder is called.
  return el('a', {href: './' + cell.report.split('/').map(encodeURIComponent).join('/')}, cell.name);
}

function remarks(cell) {
  const list = cell.warnings.slice();
  if (cell.bad_samples > 0) list.unshift(`${cell.bad_samples} samples belong to no model`);
  if (list.length === 0) return '';
  return el('details', {}, el('summary', {}, `${list.length} ${list.length === 1 ? 'remark' : 'remarks'}`), el('ul', {}, list.map((text) => el('li', {}, text))));
}

/** The errors of one cell from the right to the left. */
function spark(cell, k, x) {
  const stages = stagesOf(cell);
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 260 42');
  svg.setAttribute('class', 'spark');
  svg.setAttribute('role', 'img');
  svg.setAttribute('aria-label', stages.length === 0 ? 'no errors on held-out poses' : stages.map((stage) => `${stage.stage} ${fixed(stage.mm)} mm`).join(', '));
  charts.push({id: 'cell-' + k, svg, redraw: () => {
    const picture = d3.select(svg);
    picture.selectAll('*').remove();
    picture.append('line').attr('class', 'rule').attr('x1', 4).attr('x2', 256).attr('y1', 16).attr('y2', 16);
    for (const tick of x.ticks(3).filter((v) => /^1|^0\.0*1$/.test(String(v)))) {
      picture.append('line').attr('class', 'rule').attr('x1', x(tick)).attr('x2', x(tick)).attr('y1', 10).attr('y2', 22);
      picture.append('text').attr('class', 'muted small').attr('x', x(tick)).attr('y', 38).attr('text-anchor', 'middle').text(String(tick));
    }
    for (const stage of stages) {
      if (!(stage.mm > 0)) continue;
      if (stage.found) {
        picture.append('path').attr('class', 'curve-dot').attr('d', d3.symbol().type(d3.symbolDiamond).size(80)()).attr('transform', `translate(${x(stage.mm)},16)`);
      } else {
        picture.append('circle').attr('class', stage.stage.startsWith('identified') ? 'dot-after' : 'dot-before').attr('r', 5).attr('cx', x(stage.mm)).attr('cy', 16);
      }
    }
  }});
  return svg;
}

startTheme();
showFleet();
drawCharts();
