'use strict';
// Each finding with its curve and its rivals.

const driverTitle = (driver) => {
  if (/^q\d+$/.test(driver)) return 'joint ' + driver.slice(1) + ' [' + (jointType(Number(driver.slice(1)) - 1) === 'prismatic' ? 'mm' : '°') + ']';
  if (/^tau\d+$/.test(driver)) return 'gravity torque about joint ' + driver.slice(3) + ' [N m]';
  if (/^dir\d+$/.test(driver)) return 'side from which joint ' + driver.slice(3) + ' came';
  if (driver === 'stamp') return diagnosis && diagnosis.row_order && diagnosis.row_order.stands_in_for_stamp ? 'number of the row' : firstStamp ? 'time since the first sample [s]' : 'time [s]';
  if (driver === 'temperature') return 'temperature [°C]';
  if (driver === 'gravity') return 'load of gravity [N m]';
  if (driver === 'pixel' || driver === 'none' || driver === 'dq') return 'number of the sample';
  return driver.includes(',') ? driverTitle(driver.split(',')[0]) : driver;
};
const jointType = (k) => (report.arm.joints[k] || {}).type;

/** Joint readings in degrees or millimetres; other drivers as they are. */
function driverFactor(driver) {
  const first = driver.split(',')[0];
  if (!/^q\d+$/.test(first)) return 1;
  return jointType(Number(first.slice(1)) - 1) === 'prismatic' ? 1e3 : 180 / Math.PI;
}

function parameterRows(finding) {
  return Object.entries(finding.parameters).map(([name, value]) => {
    const unit = finding.units[name] || '';
    const shown = personal(value, unit);
    const deviation = finding.standard_deviation[name];
    if (unit === 's' && firstStamp && value >= firstStamp) return [name, figure(value - firstStamp, 4), '–', 's after the first sample'];
    return [name, Number.isInteger(value) ? String(value) : figure(value * shown.factor, 4), deviation === undefined || deviation === null ? '–' : '± ' + figure(deviation * shown.factor, 2), shown.unit];
  });
}

function shrinkageWords(finding) {
  if (finding.effect === 'bad_samples') return 'Rows that belong to no model; the figures leave them out.';
  if (finding.shrinkage_claimed) {
    return `The gap shrinks by ${percent(finding.shrinkage)} (${percent(finding.shrinkage_ci95[0])} to ${percent(finding.shrinkage_ci95[1])}) with it in the model, on held-out poses.`;
  }
  return 'These poses do not show that held-out poses are predicted better with it.';
}

function showFindings() {
  if (!diagnosis || !diagnosis.findings) return;
  const node = section('findings', diagnosis.findings.length === 1 ? 'The finding' : 'The findings', 'Findings');
  if (diagnosis.findings.length === 0) {
    node.append(el('p', {}, `No effect was found. ${diagnosis.search.explanations} explanations were weighed; the smallest sizes that would have been seen are listed below.`));
  } else {
    node.append(good('without the finding in the model, the points follow the curve. With it, they scatter around zero. One cause stands far above its rivals.'));
    node.append(legend(['before', 'model without it'], ['after', 'model with it'], ['curve', 'what the finding says']));
  }
  diagnosis.findings.forEach((finding, k) => showFinding(node, finding, report.curves[k], k));
  if (diagnosis.possibilities.length > 0) {
    node.append(el('h3', {}, 'Possible, but not shown by so few poses'));
    node.append(el('ul', {}, diagnosis.possibilities.map((finding) => el('li', {}, `${finding.effect} at ${place(finding.location)} (${sureness(finding.probability)})`))));
  }
  if (diagnosis.remaining.significant) {
    node.append(el('p', {}, `Structure is left at ${place(diagnosis.remaining.location)}, driven by ${diagnosis.remaining.driver}, that no finding explains.`));
  }
}

function legend(...entries) {
  return el('p', {}, entries.map(([kind, text]) => el('span', {class: 'key'}, el('i', {class: kind, 'aria-hidden': 'true'}), text)));
}

function showFinding(node, finding, curve, k) {
  node.append(el('h3', {}, `${finding.effect} at ${place(finding.location)}`));
  node.append(el('p', {}, curve.meaning.charAt(0).toUpperCase() + curve.meaning.slice(1) + '. ' + joined(shrinkageWords(finding))));
  if (curve.formula) node.append(el('p', {class: 'formula'}, curve.formula));
  const pair = el('div', {class: 'pair'});
  node.append(pair);
  const points = curve.points;
  if (points) {
    const visible = points.x.map((x, row) => ({row, x: x === null ? null : x * driverFactor(finding.driver) - (finding.driver === 'stamp' ? firstStamp : 0), before: points.before[row], after: points.after[row], curve: points.curve[row]})).filter((p) => p.x !== null);
    if (visible.length > 0) {
      chart(pair, {
        id: 'curve-' + k, width: 560, height: 330, words: `${points.quantity} against ${driverTitle(finding.driver)}: without the finding in the model, with it, and the curve of the finding.`,
        caption: `${points.quantity.replace(/(joint|link):/, '$1 ')} [${points.unit}] against ${driverTitle(finding.driver)}` + (visible.length > 700 ? '; points thinned' : ''),
        draw: (svg) => drawCurve(svg, visible, points.unit, finding.driver),
      });
    }
  }
  const rivals = [{name: finding.effect, location: finding.location, probability: finding.probability, own: true}]
      .concat(finding.alternatives.map((other) => ({name: other.effect, location: other.location, probability: other.probability})));
  const right = el('div', {});
  pair.append(right);
  chart(right, {
    id: 'rivals-' + k, width: 560, height: 12 + 30 * rivals.length, words: 'Probabilities: ' + rivals.map((r) => `${r.name} at ${place(r.location)} ${sureness(r.probability)}`).join('; ') + '.',
    caption: finding.alternatives.length === 0 ? 'No rival comes near.' : 'Probability of the finding and of the rivals that the data cannot exclude.',
    draw: (svg) => drawRivals(svg, rivals),
  });
  const rows = parameterRows(finding);
  const list = rows.length > 8 ? el('details', {}, el('summary', {}, `${rows.length} parameters`), table('Parameters', ['parameter', '#value', '#deviation', 'unit'], rows)) : table('Parameters', ['parameter', '#value', '#deviation', 'unit'], rows);
  if (rows.length > 0) right.append(list);
  if (finding.separate_with) right.append(el('p', {}, el('b', {}, 'What would separate them: '), finding.separate_with + '.'));
  if (finding.remedy) right.append(el('p', {}, el('b', {}, 'What to do: '), finding.remedy + '.'));
  if (finding.samples) right.append(el('p', {class: 'note'}, finding.samples.slice(0, 10).join(', ') + (finding.samples.length > 10 ? ` and ${finding.samples.length - 10} more` : '')));
}

/** Whether a curve is one of this driver alone: neighbours then have nearly the same value. */
function isSmooth(points) {
  const sorted = points.slice().sort((a, b) => a.x - b.x);
  const range = d3.max(sorted, (p) => p.curve) - d3.min(sorted, (p) => p.curve);
  const path = d3.sum(d3.pairs(sorted), ([a, b]) => Math.abs(a.curve - b.curve));
  return path <= 10 * range;
}

function drawCurve(svg, points, unit, driver) {
  const sided = driver.startsWith('dir');
  const domain = sided ? [-1.6, 1.6] : d3.extent(points, (p) => p.x);
  if (domain[0] === domain[1]) domain[1] += 1;
  const x = d3.scaleLinear().domain(domain).range([56, 548]);
  const y = d3.scaleLinear().domain(usualRange(points.flatMap((p) => [p.before, p.after, p.curve]))).nice().range([286, 10]);
  svg.append('line').attr('class', 'rule').attr('x1', 56).attr('x2', 548).attr('y1', y(0)).attr('y2', y(0));
  const spread = (p) => sided ? ((p.row * 0.618034) % 1 - 0.5) * 0.7 : 0;
  const shown = thin(points, 700);
  for (const kind of ['before', 'after']) {
    svg.append('g').selectAll('circle').data(shown.filter((p) => p[kind] !== null)).join('circle').attr('class', 'dot-' + kind)
        .attr('r', 3).attr('cx', (p) => x(p.x + spread(p))).attr('cy', (p) => within(y, p[kind])).attr('data-row', (p) => p.row);
  }
  if (sided || !isSmooth(points)) {
    svg.append('g').selectAll('line').data(shown).join('line').attr('class', 'curve')
        .attr('x1', (p) => x(p.x + spread(p)) - 4).attr('x2', (p) => x(p.x + spread(p)) + 4).attr('y1', (p) => y(p.curve)).attr('y2', (p) => y(p.curve));
  } else {
    const sorted = points.slice().sort((a, b) => a.x - b.x);
    svg.append('path').attr('class', 'curve').attr('d', d3.line().x((p) => x(p.x)).y((p) => y(p.curve))(sorted));
  }
  if (sided) {
    svg.append('g').attr('transform', 'translate(0,288)').call(d3.axisBottom(x).tickValues([-1, 1]).tickFormat((v) => v < 0 ? 'from above (−1)' : 'from below (+1)').tickSize(4));
  } else {
    axisBelow(svg, x, 288, 7);
  }
  axisLeft(svg, y, 54, 6);
  svg.append('text').attr('class', 'muted small').attr('x', 302).attr('y', 324).attr('text-anchor', 'middle').text(driverTitle(driver));
  svg.append('text').attr('class', 'muted small').attr('x', 60).attr('y', 12).text(unit);
}

/** A point outside of the chart is drawn at its edge. */
const within = (scale, value) => Math.max(scale.range()[1], Math.min(scale.range()[0], scale(value)));

function drawRivals(svg, rivals) {
  const x = d3.scaleLinear().domain([0, 1]).range([250, 480]);
  rivals.forEach((rival, k) => {
    const y = 18 + 30 * k;
    svg.append('text').attr('x', 240).attr('y', y + 4).attr('text-anchor', 'end').attr('class', rival.own ? 'strong' : '').text(`${rival.name}, ${place(rival.location)}`);
    svg.append('rect').attr('class', 'frame').attr('x', x(0)).attr('y', y - 8).attr('width', x(1) - x(0)).attr('height', 16);
    svg.append('rect').attr('class', rival.own ? 'bar' : 'bar-rival').attr('x', x(0)).attr('y', y - 8).attr('height', 16).attr('width', Math.max(1, x(rival.probability) - x(0)));
    svg.append('text').attr('x', 490).attr('y', y + 4).text(sureness(rival.probability));
  });
}
