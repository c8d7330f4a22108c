'use strict';
// Residuals: over the picture, against everything that may drive them, and in the mean over the picture.

const beforeAfter = legend(['before', `before (${modelName(report.model_before)})`], ['after', `after (${modelName(report.model_after)})`]);

/** Corners with their residual of a model: {row, u, v, du, dv}. */
function cornerResiduals(model) {
  return samples.flatMap((sample, row) => {
    const found = [];
    for (let k = 0; k + 1 < sample.corners.length; k += 2) {
      const [du, dv] = [sample.residuals[model][k], sample.residuals[model][k + 1]];
      if (du !== null && dv !== null) found.push({row, u: sample.corners[k], v: sample.corners[k + 1], du, dv});
    }
    return found;
  });
}

function thinnedWords() {
  const {measured, shown} = report.counts;
  return shown < measured ? ` Drawn: ${shown} of ${measured} samples, the worst and an even choice of the others.` : '';
}

function showResiduals() {
  const node = section('residuals', 'What the models leave', 'Residuals');
  if (report.pixels) showField(node);
  showDrivers(node);
  if (report.pixels) showLens(node);
}

function showField(node) {
  node.append(el('h3', {}, 'Over the picture'));
  node.append(good('the arrows after are short and point in random directions. A common direction, a swirl or a fan is an error that the model does not describe.'));
  const all = {before: cornerResiduals(report.model_before), after: cornerResiduals(report.model_after)};
  const start = startExaggeration(all.before, report.camera.width);
  const slider = el('input', {type: 'range', min: '0', max: '5', step: '0.05', value: String(Math.log10(start)), id: 'field-scale', 'aria-describedby': 'field-scale-value'});
  const shownScale = el('output', {id: 'field-scale-value', for: 'field-scale'});
  node.append(el('div', {class: 'controls'}, el('label', {}, 'Exaggerate ', slider, shownScale)));
  const pair = el('div', {class: 'pair'});
  node.append(pair);
  const entries = ['before', 'after'].map((kind) => chart(pair, {
    id: 'field-' + kind, width: 560, height: 24 + Math.round(560 * report.camera.height / report.camera.width),
    words: `Residuals ${kind}, as arrows over the picture. Root mean square ${length(rmsOf(kind))}.`,
    caption: `${kind === 'before' ? 'Before' : 'After'}: ${modelName(kind === 'before' ? report.model_before : report.model_after)}, ${length(rmsOf(kind))} rms on the poses that were fitted.` + (kind === 'after' ? thinnedWords() : ''),
    draw: (svg) => drawField(svg, thin(all[kind], 1600), kind, Math.pow(10, Number(slider.value))),
  }));
  const tell = () => { shownScale.textContent = '× ' + figure(Math.pow(10, Number(slider.value)), 2); };
  slider.addEventListener('input', () => { tell(); entries.forEach((entry) => entry.redraw()); });
  tell();
}

/** Of all samples, drawn or not. */
const rmsOf = (kind) => report.models_rms[kind === 'before' ? report.model_before : report.model_after];

/** The longest usual arrow becomes a twentieth of the picture. */
function startExaggeration(arrows, width) {
  const longest = d3.quantile(arrows.map((a) => Math.hypot(a.du, a.dv)).sort(d3.ascending), 0.95) || 1;
  return Math.max(1, Math.min(1e5, 0.05 * width / longest));
}

function drawField(svg, arrows, kind, scale) {
  const factor = 560 / report.camera.width;
  const height = report.camera.height * factor;
  svg.append('rect').attr('class', 'frame').attr('width', 560).attr('height', height);
  const clip = svg.append('clipPath').attr('id', 'clip-' + kind);
  clip.append('rect').attr('width', 560).attr('height', height);
  const inside = svg.append('g').attr('clip-path', `url(#clip-${kind})`);
  inside.append('path').attr('class', 'line-' + kind).attr('d', arrows.map((a) =>
      `M${(a.u * factor).toFixed(1)},${(a.v * factor).toFixed(1)}l${(a.du * scale * factor).toFixed(1)},${(a.dv * scale * factor).toFixed(1)}`).join(''));
  inside.append('path').attr('class', 'line-' + kind).attr('stroke-linecap', 'round').style('stroke-width', 3)
      .attr('d', arrows.map((a) => `M${(a.u * factor).toFixed(1)},${(a.v * factor).toFixed(1)}h0`).join(''));
  const unit = niceLength(40 / (scale * factor));
  svg.append('line').attr('class', 'line-after').attr('x1', 8).attr('x2', 8 + unit * scale * factor).attr('y1', height + 14).attr('y2', height + 14);
  svg.append('text').attr('class', 'muted small').attr('x', 16 + unit * scale * factor).attr('y', height + 18).text(figure(unit, 1) + ' px');
}

const niceLength = (value) => d3.max(d3.ticks(0, value * 1.5, 2)) || value;

/** Everything that may drive an error, as {title, of(sample)}. */
function drivers() {
  const list = [];
  const degrees = 180 / Math.PI;
  report.arm.joints.forEach((joint, k) => list.push({name: 'q' + (k + 1), title: driverTitle('q' + (k + 1)), of: (s) => s.q[k] * (joint.type === 'prismatic' ? 1e3 : degrees)}));
  report.arm.joints.forEach((_, k) => list.push({name: 'tau' + (k + 1), title: driverTitle('tau' + (k + 1)), of: (s) => s.torque ? s.torque[k] : null}));
  report.arm.joints.forEach((_, k) => list.push({name: 'dir' + (k + 1), title: driverTitle('dir' + (k + 1)), sided: true, of: (s) => s.dir ? s.dir[k] : null}));
  list.push({name: 'stamp', title: driverTitle('stamp'), of: (s) => s.stamp === undefined ? null : s.stamp - firstStamp});
  list.push({name: 'temperature', title: driverTitle('temperature'), of: (s) => s.temperature === undefined ? null : s.temperature});
  report.other_columns.forEach((name, k) => list.push({name, title: name, of: (s) => s.other ? s.other[k] : null}));
  return list.filter((driver) => {
    const values = samples.map(driver.of).filter((v) => v !== null && isFinite(v));
    return values.length > 1 && d3.max(values) - d3.min(values) > 1e-9 * Math.max(1, Math.abs(d3.max(values)));
  });
}

/** What may be drawn against the drivers, as {title, unit, of(sample, 'before' | 'after')}. */
function quantities() {
  const list = report.arm.joints.map((joint, k) => ({
    joint: k + 1, title: `error of joint ${k + 1} that explains the sample best`, unit: joint.type === 'prismatic' ? 'mm' : 'mrad', of: (s, kind) => s.joint_errors[kind][k],
  }));
  list.push({title: 'size of the residual', unit: lengthUnit, of: (s, kind) => kind === 'before' ? sizeBefore(s) : sizeAfter(s)});
  if (report.pixels) {
    const mean = (s, kind, first) => d3.mean(s.residuals[kind === 'before' ? report.model_before : report.model_after].filter((v, k) => k % 2 === first && v !== null));
    list.push({title: 'mean residual to the right', unit: 'px', of: (s, kind) => mean(s, kind, 0)}, {title: 'mean residual downwards', unit: 'px', of: (s, kind) => mean(s, kind, 1)});
  } else {
    ['x', 'y', 'z'].forEach((name, k) => list.push({title: `residual along ${name} of the instrument`, unit: 'mm', of: (s, kind) => {
      const r = s.residuals[kind === 'before' ? report.model_before : report.model_after];
      return r[r.length - 3 + k];
    }}));
  }
  return list;
}

function showDrivers(node) {
  node.append(el('h3', {}, 'Against every joint, torque, direction and time'));
  node.append(good('the filled points lie flat around zero in every small chart. A slope, a wave or a step against one of them is a lead.'));
  const all = quantities();
  const found = diagnosis && diagnosis.findings && diagnosis.findings.find((finding) => finding.location.startsWith('joint:'));
  const choice = el('select', {id: 'quantity'}, all.map((q, k) => el('option', {value: String(k)}, `${q.title} [${q.unit}]`)));
  choice.value = String(found ? Number(found.location.slice(6)) - 1 : all.length - (report.pixels ? 3 : 4));
  node.append(el('div', {class: 'controls'}, el('label', {}, 'Draw ', choice)), beforeAfter);
  const grid = el('div', {class: 'grid'});
  node.append(grid);
  const entries = drivers().map((driver, k) => chart(grid, {
    id: 'driver-' + k, width: 250, height: 186, words: 'Residuals before and after against ' + driver.title + '.',
    draw: (svg) => drawDriver(svg, driver, all[Number(choice.value)]),
  }));
  choice.addEventListener('change', () => entries.forEach((entry) => entry.redraw()));
  const torques = samples.some((s) => s.torque);
  node.append(el('p', {class: 'note'}, (torques ? '' : 'The robot file states no masses, so that gravity torques are not known. ') +
      'Dark bars: means of the filled points in eight parts, with twice their standard error. Dark dots: what a finding says. Points outside are drawn at the edge.' + thinnedWords()));
}

function drawDriver(svg, driver, quantityShown) {
  const points = samples.map((s, row) => ({row, x: driver.of(s), before: quantityShown.of(s, 'before'), after: quantityShown.of(s, 'after')}))
      .filter((p) => p.x !== null && isFinite(p.x) && p.after !== null && p.after !== undefined);
  const domain = driver.sided ? [-1.7, 1.7] : d3.extent(points, (p) => p.x);
  const x = d3.scaleLinear().domain(domain).range([38, 244]);
  const y = d3.scaleLinear().domain(usualRange(points.flatMap((p) => [p.before, p.after]), {tail: 0.02})).nice(4).range([144, 8]);
  svg.append('line').attr('class', 'rule').attr('x1', 38).attr('x2', 244).attr('y1', y(0)).attr('y2', y(0));
  const spread = (p) => driver.sided ? ((p.row * 0.618034) % 1 - 0.5) * 0.9 : 0;
  const shown = thin(points, 400);
  for (const kind of ['before', 'after']) {
    svg.append('g').selectAll('circle').data(shown.filter((p) => p[kind] !== null && p[kind] !== undefined)).join('circle').attr('class', 'dot-' + kind).attr('r', 2)
        .attr('cx', (p) => x(p.x + spread(p))).attr('cy', (p) => within(y, p[kind])).attr('data-row', (p) => p.row);
  }
  drawFound(svg, points, x, y, driver, quantityShown, spread);
  drawMeans(svg, points, x, y, driver.sided);
  if (driver.sided) {
    svg.append('g').attr('transform', 'translate(0,146)').call(d3.axisBottom(x).tickValues([-1, 1]).tickFormat((v) => v < 0 ? '−1' : '+1').tickSize(3));
  } else {
    axisBelow(svg, x, 146, 4);
  }
  axisLeft(svg, y, 36, 4);
  svg.append('text').attr('class', 'muted small').attr('x', 141).attr('y', 181).attr('text-anchor', 'middle').text(driver.title);
}

/** The curves of findings at this joint that this driver moves. */
function drawFound(svg, points, x, y, driver, quantityShown, spread) {
  for (const curve of report.curves) {
    if (!quantityShown.joint || curve.location !== 'joint:' + quantityShown.joint || curve.driver !== driver.name || !curve.points) continue;
    svg.append('g').selectAll('circle').data(thin(points, 400)).join('circle').attr('class', 'curve-dot').attr('r', 1)
        .attr('cx', (p) => x(p.x + spread(p))).attr('cy', (p) => within(y, curve.points.curve[p.row]));
  }
}

/** Means of the points after in parts of equal count, with twice their standard error. */
function drawMeans(svg, points, x, y, sided) {
  const sorted = points.slice().sort((a, b) => a.x - b.x);
  const parts = sided ? d3.nest().key((p) => p.x).entries(sorted).map((g) => g.values) : d3.range(8).map((k) => sorted.slice(Math.floor(k * sorted.length / 8), Math.floor((k + 1) * sorted.length / 8)));
  for (const part of parts) {
    if (part.length < 4) continue;
    const mean = d3.mean(part, (p) => p.after), error = 2 * d3.deviation(part, (p) => p.after) / Math.sqrt(part.length), at = x(d3.median(part, (p) => p.x));
    svg.append('line').attr('class', 'curve').attr('x1', at).attr('x2', at).attr('y1', within(y, mean - error)).attr('y2', within(y, mean + error));
    svg.append('line').attr('class', 'curve').attr('x1', at - 4).attr('x2', at + 4).attr('y1', within(y, mean)).attr('y2', within(y, mean));
  }
}

function showLens(node) {
  node.append(el('h3', {}, 'Mean residual over the picture'));
  node.append(good('pale everywhere: the mean residual of each part of the picture is no longer than noise makes it. Adjacent dark parts mean that the lens model does not fit well.'));
  const columns = 12, rows = Math.max(4, Math.round(columns * report.camera.height / report.camera.width));
  const cells = lensCells(columns, rows);
  const counted = cells.filter((cell) => cell.count >= 2);
  const worst = counted.slice().sort((a, b) => b.sigmas - a.sigmas)[0];
  chart(node, {
    id: 'lens', width: 960, height: 4 + Math.round(720 * report.camera.height / report.camera.width),
    words: `Mean residual of the model after, by part of the picture. ${counted.length} of ${cells.length} parts are in two pictures or more.` + (worst ? ` Largest: ${length(worst.length)}, ${figure(worst.sigmas, 2)} standard errors.` : ''),
    caption: 'Mean residual of the corners in each part of the picture, model after. Colour: its length in standard errors; arrow: its direction; parts seen in fewer than two pictures are empty.',
    draw: (svg) => drawLens(svg, cells, columns, rows),
  });
}

function lensCells(columns, rows) {
  const cells = d3.range(columns * rows).map((k) => ({column: k % columns, row: Math.floor(k / columns), samples: new Map()}));
  for (const corner of cornerResiduals(report.model_after)) {
    const column = Math.floor(columns * (corner.u + 0.5) / report.camera.width), row = Math.floor(rows * (corner.v + 0.5) / report.camera.height);
    if (column < 0 || row < 0 || column >= columns || row >= rows) continue;
    const seen = cells[row * columns + column].samples;
    if (!seen.has(corner.row)) seen.set(corner.row, []);
    seen.get(corner.row).push(corner);
  }
  // Corners of one picture are off together, so that a picture counts once in a part.
  for (const cell of cells) cell.means = Array.from(cell.samples.values(), (corners) => ({du: d3.mean(corners, (c) => c.du), dv: d3.mean(corners, (c) => c.dv)}));
  const sigma = Math.sqrt((d3.mean(cells.flatMap((cell) => cell.means), (m) => m.du * m.du + m.dv * m.dv) || 0) / 2) || 1e-12;
  for (const cell of cells) {
    cell.count = cell.means.length;
    cell.du = d3.mean(cell.means, (m) => m.du) || 0;
    cell.dv = d3.mean(cell.means, (m) => m.dv) || 0;
    cell.length = Math.hypot(cell.du, cell.dv);
    cell.sigmas = cell.length * Math.sqrt(cell.count) / sigma;
  }
  return cells;
}

function drawLens(svg, cells, columns, rows) {
  const width = 720, height = 720 * report.camera.height / report.camera.width, w = width / columns, h = height / rows;
  const shade = d3.scaleLinear().domain([1, 5]).range([0.04, 1]).clamp(true);
  svg.append('rect').attr('class', 'frame').attr('width', width).attr('height', height);
  const longest = d3.max(cells.filter((c) => c.count >= 2), (c) => c.length) || 1;
  for (const cell of cells) {
    if (cell.count < 2) continue;
    const [x, y] = [cell.column * w, cell.row * h];
    svg.append('rect').attr('class', 'bar').attr('x', x + 1).attr('y', y + 1).attr('width', w - 2).attr('height', h - 2).style('opacity', shade(cell.sigmas));
    const scale = 0.42 * Math.min(w, h) / longest, cx = x + w / 2, cy = y + h / 2;
    svg.append('path').attr('class', 'curve').style('stroke-width', 1.2).attr('d', `M${cx - cell.du * scale},${cy - cell.dv * scale}L${cx + cell.du * scale},${cy + cell.dv * scale}`);
    svg.append('circle').attr('class', 'curve-dot').attr('r', 1.8).attr('cx', cx + cell.du * scale).attr('cy', cy + cell.dv * scale);
  }
  const left = width + 40;
  svg.append('text').attr('class', 'muted small').attr('x', left).attr('y', 14).text('length in standard errors');
  [1, 2, 3, 4, 5].forEach((sigmas, k) => {
    svg.append('rect').attr('class', 'bar').attr('x', left).attr('y', 26 + 24 * k).attr('width', 34).attr('height', 20).style('opacity', shade(sigmas));
    svg.append('text').attr('x', left + 44).attr('y', 40 + 24 * k).text(k === 0 ? '1 or less' : k === 4 ? '5 or more' : String(sigmas));
  });
  svg.append('text').attr('class', 'muted small').attr('x', left).attr('y', 172).text('longest arrow ' + figure(longest, 2) + ' px');
}
