'use strict';
// Parameters, the worst samples, and what could have been found.

/** "joint 3 tilt a": an angle; "joint 3 shift a": a length. */
const isAngle = (name) => / tilt /.test(name);

function showParameters() {
  const node = section('parameters', 'Parameters', 'Parameters');
  node.append(good('bars are short compared with their distance from zero: the data determine the axis. Where a bar is as long as the tolerance, the data say little.'));
  const moved = report.parameters.filter((p) => p.value !== null && p.standard_deviation !== null);
  const pair = el('div', {class: 'pair'});
  node.append(pair);
  for (const [id, angle, unit] of [['tilts', true, 'mrad'], ['shifts', false, 'mm']]) {
    const list = moved.filter((p) => isAngle(p.name) === angle);
    if (list.length === 0) continue;
    chart(pair, {
      id: 'parameters-' + id, width: 560, height: 40 + 20 * list.length, words: `How each axis was moved from its nominal place [${unit}]: ` + list.map((p) => `${p.name} ${figure(1e3 * p.value)} ± ${figure(1e3 * p.standard_deviation, 2)}`).join('; ') + '.',
      caption: `${angle ? 'Tilts' : 'Shifts'} of the axes from their nominal places [${unit}], bars: ± 2 standard deviations. Pale: mostly decided by the tolerance.`, draw: (svg) => drawParameters(svg, list),
    });
  }
  node.append(el('details', {}, el('summary', {}, `All ${report.parameters.length} parameters in a table`), table('Parameters of the fit, in m and rad', ['parameter', '#moved by', '#standard deviation', '#share of the tolerance'],
      report.parameters.map((p) => [p.name, p.value === null ? '–' : figure(p.value), figure(p.standard_deviation), p.variance_from_prior === undefined || p.variance_from_prior === null ? '–' : percent(Math.min(1, p.variance_from_prior))]))));
  const {unseen, gauge} = identification.observability;
  node.append(el('h3', {}, 'What the data could not see'));
  if (unseen.length === 0 && gauge.length === 0) node.append(el('p', {}, 'Nothing: these poses determine every parameter.'));
  if (unseen.length > 0) node.append(el('details', unseen.length <= 8 ? {open: ''} : {}, el('summary', {}, `${unseen.length} directions that the tolerances decide`), el('ul', {}, unseen.map((text) => el('li', {}, text)))));
  if (gauge.length > 0) node.append(el('details', {}, el('summary', {}, 'What no data of this kind tell, and how it was fixed'), el('ul', {}, gauge.map((text) => el('li', {}, text)))));
}

function drawParameters(svg, list) {
  const ends = list.flatMap((p) => [1e3 * (p.value - 2 * p.standard_deviation), 1e3 * (p.value + 2 * p.standard_deviation), 0]);
  const x = d3.scaleLinear().domain(d3.extent(ends)).nice().range([140, 545]);
  const bottom = 8 + 20 * list.length;
  svg.append('line').attr('class', 'rule').attr('x1', x(0)).attr('x2', x(0)).attr('y1', 2).attr('y2', bottom);
  list.forEach((p, k) => {
    const y = 14 + 20 * k, share = Math.min(1, p.variance_from_prior || 0), value = 1e3 * p.value, deviation = 2e3 * p.standard_deviation;
    const row = svg.append('g').style('opacity', 1 - 0.7 * share);
    row.append('text').attr('class', 'small').attr('x', 130).attr('y', y + 4).attr('text-anchor', 'end').text(p.name);
    row.append('line').attr('class', 'line-after').attr('x1', x(value - deviation)).attr('x2', x(value + deviation)).attr('y1', y).attr('y2', y);
    row.append('circle').attr('class', 'dot-after').attr('r', 3.2).attr('cx', x(value)).attr('cy', y);
  });
  axisBelow(svg, x, bottom + 4, 7);
}

function showWorst() {
  const node = section('worst', 'The worst samples', 'Worst samples');
  node.append(good('the worst are not much worse than the others, and none stands out by itself.'));
  const why = new Map(report.suspects.map((suspect) => [suspect.sample, suspect.why]));
  const rows = samples.map((sample, row) => ({sample, row})).sort((a, b) => sizeAfter(b.sample) - sizeAfter(a.sample)).slice(0, 12);
  const middle = d3.median(samples, sizeAfter);
  const show = (row) => {
    const button = el('button', {type: 'button', 'data-row': String(row)}, 'show');
    button.setAttribute('aria-label', 'Show ' + sampleName(row));
    button.addEventListener('click', () => document.getElementById('space').scrollIntoView());
    return button;
  };
  node.append(table(`Root mean square residual; the median of all shown is ${length(middle)}`, ['sample', '#line', `#before [${lengthUnit}]`, `#after [${lengthUnit}]`, '#times the median', 'remark', ''],
      rows.map(({sample, row}) => [sample.image || '–', String(sample.line), fixed(sizeBefore(sample)), fixed(sizeAfter(sample)), middle > 0 ? figure(sizeAfter(sample) / middle, 2) : '–', why.get(sample.sample) || '', show(row)])));
}

function showDetectable() {
  if (!diagnosis || !diagnosis.detectable) return;
  const node = section('detectable', 'What would have been found', 'Detectable');
  node.append(good('sizes that would matter to you lie to the right of the dots. An effect that is smaller than its dot may be there unseen.'));
  const byUnit = d3.nest().key((d) => d.unit).entries(diagnosis.detectable.filter((d) => d.smallest > 0 && isFinite(d.smallest)));
  const grid = el('div', {class: 'pair'});
  node.append(grid);
  byUnit.sort((a, b) => b.values.length - a.values.length).forEach(({key, values}, k) => {
    const effects = d3.nest().key((d) => d.effect).entries(values);
    const middle = personal(d3.median(values, (d) => d.smallest), key);
    chart(grid, {
      id: 'detectable-' + k, width: 560, height: 44 + 22 * effects.length, words: `Smallest size found four times in five [${middle.unit || 'no unit'}]: ` + effects.map((e) => `${e.key} from ${figure(middle.factor * d3.min(e.values, (d) => d.smallest), 2)}`).join('; ') + '.',
      caption: `Smallest size that is found four times in five [${middle.unit || 'no unit'}]; one dot a place. Dark: what was found.`, draw: (svg) => drawDetectable(svg, effects, key, middle.factor),
    });
  });
  node.append(el('details', {}, el('summary', {}, `All ${diagnosis.detectable.length} in a table`), table('Minimum detectable size', ['effect', 'place', '#smallest'], diagnosis.detectable.map((d) => [d.effect, place(d.location), quantity(d.smallest, d.unit)]))));
  if (diagnosis.not_testable.length > 0) {
    node.append(el('h3', {}, 'What this capture cannot show'));
    const groups = d3.nest().key((d) => d.effect + '\n' + d.why).entries(diagnosis.not_testable.filter((d) => d.effect !== 'joint_offset'));
    node.append(table('Effects that these data cannot show', ['effect', 'places', 'why'], groups.map(({values}) => [values[0].effect, values.map((d) => place(d.location)).join(', '), values[0].why])));
  }
}

/** Sizes of findings of this kind and unit, to be seen beside what would have been seen. */
function foundSizes(effect, unit) {
  return diagnosis.findings.filter((f) => f.effect === effect).flatMap((f) => Object.keys(f.parameters).filter((name) => f.units[name] === unit && f.standard_deviation[name] > 0).map((name) => Math.abs(f.parameters[name])));
}

function drawDetectable(svg, effects, unit, factor) {
  const found = effects.map((e) => foundSizes(e.key, unit));
  const all = effects.flatMap((e) => e.values.map((d) => d.smallest)).concat(...found).map((v) => v * factor);
  const x = d3.scaleLog().domain([d3.min(all) / 1.5, d3.max(all) * 1.5]).range([170, 545]);
  const bottom = 10 + 22 * effects.length;
  effects.forEach((effect, k) => {
    const y = 14 + 22 * k;
    svg.append('text').attr('class', 'small').attr('x', 160).attr('y', y + 4).attr('text-anchor', 'end').text(effect.key);
    svg.append('line').attr('class', 'rule').attr('x1', 170).attr('x2', 545).attr('y1', y).attr('y2', y);
    svg.append('g').selectAll('circle').data(effect.values).join('circle').attr('class', 'dot-after').style('opacity', 0.6).attr('r', 4).attr('cx', (d) => x(factor * d.smallest)).attr('cy', y)
        .append('title').text((d) => `${place(d.location)}: ${quantity(d.smallest, d.unit)}`);
    for (const size of found[k]) svg.append('path').attr('class', 'curve-dot').attr('d', d3.symbol().type(d3.symbolDiamond).size(90)()).attr('transform', `translate(${x(factor * size)},${y})`);
  });
  axisBelow(svg, x, bottom + 2, 4, '~g');
}
