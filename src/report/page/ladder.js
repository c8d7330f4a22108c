'use strict';
// The verdict, and the stages on held-out poses.

function showVerdict() {
  const verdict = report.verdict;
  const counts = report.counts;
  document.title = verdict.headline + ' – poecal report';
  document.getElementById('about').textContent =
      `${report.robot}, ${counts.measured} of ${counts.samples} samples with ${report.pixels ? 'corners' : 'measured poses'}, ` +
      (report.setup === 'eye_in_hand' ? 'camera on the flange' : 'target on the flange');
  const node = section('verdict', verdict.headline, 'Verdict');
  const title = node.querySelector('h2');
  title.replaceWith(el('h1', {id: 'verdict-title'}, verdict.headline));
  node.append(el('div', {class: 'lead'}, verdict.sentences.map((sentence) => el('p', {}, joined(sentence)))));
  node.append(el('div', {class: 'todo'}, el('h2', {}, 'What to do'), el('ul', {}, verdict.actions.map((action) => el('li', {}, action)))));
  node.append(keyFigures());
  if (report.warnings.length > 0) {
    node.append(el('details', {open: ''}, el('summary', {}, 'Warnings'), el('ul', {}, report.warnings.map((text) => el('li', {}, text)))));
  }
}

function keyFigures() {
  const stages = report.ladder.stages;
  const first = stages[0], last = stages[stages.length - 1];
  const entries = [
    ['Error of the nominal arm', fixed(first.rms) + ' ' + lengthUnit, fixed(first.position_mm) + ' mm at the flange'],
    ['Error of the best model', fixed(last.rms) + ' ' + lengthUnit, fixed(last.position_mm) + ' mm at the flange'],
  ];
  if (diagnosis && diagnosis.gap) {
    const gap = diagnosis.gap, suffix = report.pixels ? '_px' : '_mm';
    const interval = gap['after_excess_ci95' + suffix];
    entries.push(['Gap that remains', fixed(gap['after_excess' + suffix]) + ' ' + lengthUnit, `${fixed(interval[0])} to ${fixed(interval[1])} ${lengthUnit}`]);
    entries.push(['Gap closed', gap.shrinkage_claimed ? percent(gap.shrinkage) : '–',
      gap.shrinkage_claimed ? `${percent(gap.shrinkage_ci95[0])} to ${percent(gap.shrinkage_ci95[1])}` : 'nothing claimed']);
    if (report.ladder.noise.known) entries.push(['Noise', fixed(report.ladder.noise.rms) + ' ' + lengthUnit, report.ladder.noise.source]);
  }
  return el('dl', {class: 'figures'}, entries.map(([name, value, more]) =>
      el('div', {}, el('dt', {}, name), el('dd', {}, value + ' ', el('small', {}, more)))));
}

/** "identified + a@joint:1 + b@joint:2" -> "+ b at joint 2". */
function stageLabel(stage) {
  const parts = stage.split(' + ');
  if (parts.length === 1) return stage;
  const [effect, location] = parts[parts.length - 1].split('@');
  return '+ ' + effect + (location ? ' at ' + place(location) : '');
}

function ladderRows() {
  const ladder = report.ladder;
  const rows = ladder.stages.map((stage) => ({label: stageLabel(stage.stage), rms: stage.rms, interval: stage.rms_ci95, mm: stage.position_mm, mrad: stage.rotation_mrad}));
  if (ladder.noise) rows.push({label: ladder.noise.known ? 'noise' : 'noise, at most', rms: ladder.noise.known ? ladder.noise.rms : ladder.noise.bounds[1], interval: ladder.noise.bounds, noise: true});
  if (ladder.free_pose) rows.push({label: 'a free pose for each', rms: ladder.free_pose, interval: [ladder.free_pose, ladder.free_pose], noise: true});
  return rows;
}

function showLadder() {
  const rows = ladderRows();
  const node = section('stages', 'From the nominal arm to the noise', 'Stages');
  node.append(good('every stage lies to the left of the one before. The last one reaches the noise band.'));
  const where = report.ladder.held_out ? 'poses that the fit did not see' : 'the poses that were fitted';
  const words = rows.map((row) => `${row.label}: ${length(row.rms)}`).join('; ');
  chart(node, {
    id: 'ladder', width: 960, height: 46 + 34 * rows.length, words: `Root mean square error of each stage on ${where}. ${words}.`,
    caption: `Root mean square ${report.pixels ? 'length of a corner’s residual' : 'distance'} on ${where}, logarithmic; bars: 95 % intervals from resampled poses. Beside it the mean error of the flange.`,
    draw: (svg) => drawLadder(svg, rows),
  });
}

function drawLadder(svg, rows) {
  const left = 250, right = 700, top = 12, step = 34, bottom = top + step * rows.length;
  const ends = rows.flatMap((row) => [row.rms, ...row.interval]).filter((v) => v > 0);
  const x = d3.scaleLog().domain([d3.min(ends) / 1.4, d3.max(ends) * 1.3]).range([left, right]);
  const noise = rows.find((row) => row.noise);
  if (noise && noise.rms > 0) {
    const [low, high] = [x(Math.max(noise.interval[0], x.domain()[0])), x(noise.interval[1] || noise.rms)];
    svg.append('rect').attr('class', 'band').attr('x', Math.min(low, high - 3)).attr('width', Math.max(3, high - low)).attr('y', top).attr('height', bottom - top);
  }
  const titles = [[right + 90, 'rms ' + lengthUnit], [right + 170, 'mean mm'], [right + 250, 'mean mrad']];
  for (const [at, text] of titles) svg.append('text').attr('class', 'muted small').attr('x', at).attr('y', top - 2).attr('text-anchor', 'end').text(text);
  rows.forEach((row, k) => {
    const y = top + step * (k + 0.5);
    svg.append('line').attr('class', 'rule').attr('x1', left).attr('x2', right).attr('y1', y).attr('y2', y);
    svg.append('text').attr('x', left - 14).attr('y', y + 4).attr('text-anchor', 'end').attr('class', row.noise ? 'muted' : '').text(row.label);
    const clamp = (v) => x(Math.max(v, x.domain()[0]));
    if (!row.noise) svg.append('line').attr('class', 'line-after').attr('stroke-width', 4).style('stroke-width', 4).style('opacity', 0.35).attr('x1', clamp(row.interval[0])).attr('x2', clamp(row.interval[1])).attr('y1', y).attr('y2', y);
    svg.append('circle').attr('class', row.noise ? 'dot-before' : 'dot-after').attr('cx', clamp(row.rms)).attr('cy', y).attr('r', 5);
    const cells = [[right + 90, fixed(row.rms)], [right + 170, row.noise ? '' : fixed(row.mm)], [right + 250, row.noise ? '' : fixed(row.mrad)]];
    for (const [at, text] of cells) svg.append('text').attr('x', at).attr('y', y + 4).attr('text-anchor', 'end').text(text);
  });
  axisBelow(svg, x, bottom + 2, 5, '~g');
  svg.append('text').attr('class', 'muted small').attr('x', right + 8).attr('y', bottom + 18).text(lengthUnit);
}
