'use strict';
// The picked sample: its picture with detected and predicted corners, or its measured pose.

const pictureOf = new Map(pictures.pictures.map((picture) => [picture.row, picture]));

function sampleName(row) {
  const sample = samples[row];
  return sample.image || 'line ' + sample.line;
}

function sampleWords(row) {
  const sample = samples[row];
  const suspect = report.suspects.find((each) => each.sample === sample.sample);
  return `${sampleName(row)}: ${length(sizeBefore(sample))} before, ${length(sizeAfter(sample))} after` + (suspect ? ', ' + suspect.why : '');
}

function showSample(pair) {
  const box = el('div', {});
  pair.append(box);
  const slider = el('input', {type: 'range', min: '0', max: String(samples.length - 1), step: '1', value: '0', 'aria-label': 'Sample'});
  const words = el('p', {class: 'note', 'aria-live': 'polite'});
  const step = (by, label, name) => {
    const button = el('button', {type: 'button', 'aria-label': name}, label);
    button.addEventListener('click', () => pick(picked.row + by));
    return button;
  };
  box.append(el('div', {class: 'controls'}, step(-1, '◀', 'Previous sample'), slider, step(1, '▶', 'Next sample')), words);
  const entries = [];
  if (report.pixels) {
    entries.push(chart(box, {id: 'sample', width: 560, height: Math.round(560 * report.camera.height / report.camera.width), words: 'The picked picture with detected corners.', draw: drawWhole}));
    entries.push(chart(box, {id: 'sample-near', width: 560, height: 300, words: 'The part of it around the corners, detected corners as rings, predicted ones by arrows.',
      caption: 'Rings: detected. Lines: to where the model predicts them, grey before, coloured after, exaggerated so that the longest can be seen.', draw: drawNear}));
  } else {
    entries.push(chart(box, {id: 'sample', width: 560, height: 230, words: 'Residual of the picked pose along each axis of the instrument.', caption: 'Residual of the picked pose along x, y, z of the instrument, before and after.', draw: drawPose}));
  }
  const tell = () => {
    slider.value = String(picked.row);
    words.textContent = sampleWords(picked.row) + (report.pixels && pictureOf.size > 0 && !pictureOf.has(picked.row) ? '. Its picture is not in this page.' : '.');
  };
  slider.addEventListener('input', () => pick(Number(slider.value)));
  picked.listeners.push(() => { tell(); entries.forEach((entry) => entry.redraw()); });
  tell();
  if (report.pixels && pictures.pictures.length < samples.length) {
    const text = pictures.pictures.length === 0 ? 'The pictures of this capture are no longer in its folder, so none is shown.'
        : `Pictures of ${pictures.pictures.length} of ${report.counts.measured} samples are in this page: the worst, and an even choice of the others.`;
    box.append(el('p', {class: 'note'}, text));
  }
}

function cornersOf(row) {
  const sample = samples[row];
  return d3.range(sample.corners.length / 2).map((k) => ({u: sample.corners[2 * k], v: sample.corners[2 * k + 1],
    before: [sample.residuals[report.model_before][2 * k], sample.residuals[report.model_before][2 * k + 1]],
    after: [sample.residuals[report.model_after][2 * k], sample.residuals[report.model_after][2 * k + 1]]}));
}

function drawWhole(svg) {
  const factor = 560 / report.camera.width, height = report.camera.height * factor;
  svg.append('rect').attr('class', 'frame').attr('width', 560).attr('height', height);
  const picture = pictureOf.get(picked.row);
  if (picture) svg.append('image').attr('href', picture.whole).attr('width', 560).attr('height', height).attr('preserveAspectRatio', 'none');
  svg.append('g').selectAll('circle').data(cornersOf(picked.row)).join('circle').attr('class', 'line-after').attr('r', 4).attr('cx', (c) => c.u * factor).attr('cy', (c) => c.v * factor);
}

function drawNear(svg) {
  const corners = cornersOf(picked.row);
  const picture = pictureOf.get(picked.row);
  const [u0, v0, width, height] = picture && picture.part ? picture.part : around(corners);
  const factor = Math.min(560 / width, 300 / height), left = (560 - width * factor) / 2;
  svg.append('rect').attr('class', 'frame').attr('x', left).attr('width', width * factor).attr('height', height * factor);
  if (picture && picture.near) svg.append('image').attr('href', picture.near).attr('x', left).attr('width', width * factor).attr('height', height * factor).attr('preserveAspectRatio', 'none');
  const x = (u) => left + (u - u0 + 0.5) * factor, y = (v) => (v - v0 + 0.5) * factor;
  const known = corners.filter((c) => c.before[0] !== null && c.after[0] !== null);
  const longest = d3.max(known, (c) => Math.max(Math.hypot(...c.before), Math.hypot(...c.after))) || 1;
  const scale = Math.max(1, niceLength(0.2 * Math.min(width, height) / longest));
  for (const c of known) {
    for (const kind of ['before', 'after']) {
      // What was measured less what the model expects: the prediction lies the other way.
      svg.append('line').attr('class', 'line-' + kind).style('stroke-width', 2.4).attr('x1', x(c.u)).attr('y1', y(c.v)).attr('x2', x(c.u - c[kind][0] * scale)).attr('y2', y(c.v - c[kind][1] * scale));
    }
  }
  svg.append('g').selectAll('circle').data(corners).join('circle').attr('class', 'line-after').attr('r', 5).attr('cx', (c) => x(c.u)).attr('cy', (c) => y(c.v));
  svg.append('text').attr('class', 'small strong').attr('x', 4).attr('y', 14).text('lines × ' + figure(scale, 2));
}

function around(corners) {
  const [u0, u1] = d3.extent(corners, (c) => c.u), [v0, v1] = d3.extent(corners, (c) => c.v);
  const half = Math.max(16, u1 - u0, v1 - v0);
  return [(u0 + u1) / 2 - half, (v0 + v1) / 2 - half, 2 * half, 2 * half];
}

function drawPose(svg) {
  const sample = samples[picked.row];
  const last = (model) => sample.residuals[model].slice(-3);
  const bars = ['x', 'y', 'z'].map((name, k) => ({name, before: last(report.model_before)[k], after: last(report.model_after)[k]}));
  const x = d3.scaleLinear().domain(usualRange(bars.flatMap((b) => [b.before, b.after, 0]), {symmetric: true})).range([60, 540]);
  bars.forEach((bar, k) => {
    const y = 24 + 56 * k;
    svg.append('text').attr('x', 30).attr('y', y + 14).text(bar.name);
    svg.append('rect').attr('class', 'bar-rival').attr('x', Math.min(x(0), x(bar.before))).attr('y', y).attr('height', 12).attr('width', Math.abs(x(bar.before) - x(0)));
    svg.append('rect').attr('class', 'bar').attr('x', Math.min(x(0), x(bar.after))).attr('y', y + 14).attr('height', 12).attr('width', Math.abs(x(bar.after) - x(0)));
  });
  axisBelow(svg, x, 190, 6);
  svg.append('text').attr('class', 'muted small').attr('x', 545).attr('y', 208).text('mm');
}
