'use strict';
// The arm in space: drawn with lines in an orthographic view, so that it prints and needs no graphics card.

const postures = report.arm.postures;
const view = {turn: -0.7, tilt: 0.35, zoom: 1, stretch: 30, model: report.model_before};

const point = (list, k) => [list[3 * k], list[3 * k + 1], list[3 * k + 2]];
const plus = (a, b, factor = 1) => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
const minus = (a, b) => plus(a, b, -1);
const points = (list) => d3.range(list.length / 3).map((k) => point(list, k));

/** The posture of the picked sample, or the one nearest to it in the list. */
function pickedPosture() {
  return postures.reduce((best, posture) => Math.abs(posture.row - picked.row) < Math.abs(best.row - picked.row) ? posture : best);
}

/** All that is drawn at some sample, and half its extent. */
const space3 = (() => {
  const all = postures.flatMap((p) => [...points(p.identified.points), ...cameraEnds(p, 0.1), ...points(p.target)]).concat([[0, 0, 0]]);
  const half = [0, 1, 2].map((k) => (d3.max(all, (p) => p[k]) - d3.min(all, (p) => p[k])) / 2);
  return {all, radius: Math.hypot(...half) || 1};
})();

/** Base to picture: x to the right, y downwards; all that is drawn at some sample has room. */
function projector(width, height) {
  const [st, ct, sv, cv] = [Math.sin(view.turn), Math.cos(view.turn), Math.sin(view.tilt), Math.cos(view.tilt)];
  const flat = (p) => [ct * p[0] - st * p[1], -(cv * p[2] + sv * (st * p[0] + ct * p[1]))];
  const seen = space3.all.map(flat);
  const [left, right] = d3.extent(seen, (p) => p[0]), [top, bottom] = d3.extent(seen, (p) => p[1]);
  const scale = view.zoom * Math.min((width - 70) / (right - left || 1), (height - 50) / (bottom - top || 1));
  return (p) => {
    const [x, y] = flat(p);
    return [width / 2 + scale * (x - (left + right) / 2), height / 2 + scale * (y - (top + bottom) / 2)];
  };
}

/** The camera's place and the four ends of its pyramid, whose opening is that of the picture. */
function cameraEnds(posture, depth) {
  const [origin, x, y, z] = points(posture.camera);
  const wide = report.camera ? report.camera.width / (2 * report.camera.focal_length) : 0.3;
  const tall = report.camera ? wide * report.camera.height / report.camera.width : 0.3;
  const corner = (a, b) => plus(plus(plus(origin, z, depth), x, a * wide * depth), y, b * tall * depth);
  return [origin, corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
}

/** Misses are stretched more than the arm, by a power of ten that lets them be seen. */
function missStretch() {
  const usual = d3.median(postures, (p) => Math.hypot(...point(p.miss, view.model))) / 1000;
  const wanted = usual > 0 ? 0.04 * space3.radius / (30 * usual) : 1;
  return view.stretch * Math.pow(10, Math.max(0, Math.min(5, Math.round(Math.log10(wanted)))));
}

function showSpace() {
  const node = section('space', 'The arm, its camera and a sample', 'Arm and samples');
  node.append(good('the two arms can hardly be told apart until they are exaggerated, and the short lines at the target, where the compared model misses, have no common pattern.'));
  const slider = el('input', {type: 'range', min: '0', max: '3', step: '0.02', value: '1.5', 'aria-label': 'Exaggerate the errors of the arm'});
  const scale = el('output');
  const choice = el('select', {'aria-label': 'Model whose misses are drawn'}, report.models.map((name, k) => k === report.model_after ? null : el('option', {value: String(k)}, name)));
  choice.value = String(view.model);
  const buttons = [['−', 0, -1, 'Smaller'], ['+', 0, 1, 'Larger'], ['◀', -1, 0, 'Turn left'], ['▶', 1, 0, 'Turn right']].map(([label, turn, zoom, words]) => {
    const button = el('button', {type: 'button', 'aria-label': words}, label);
    button.addEventListener('click', () => { view.turn += 0.2 * turn; view.zoom *= Math.pow(1.15, zoom); space.redraw(); });
    return button;
  });
  node.append(el('div', {class: 'controls'}, el('label', {}, 'Exaggerate ', slider, scale), el('label', {}, 'Misses of ', choice), el('span', {}, ...buttons)));
  node.append(el('p', {}, el('span', {class: 'key'}, el('i', {class: 'before', 'aria-hidden': 'true'}), 'nominal arm'), el('span', {class: 'key'}, el('i', {class: 'after', 'aria-hidden': 'true'}), 'identified, its differences exaggerated'), el('span', {class: 'key'}, 'dashed and full lines: axes of the joints')));
  const pair = el('div', {class: 'pair'});
  node.append(pair);
  const space = chart(pair, {
    id: 'space', width: 560, height: 470, words: `The arm ${report.robot} at the picked sample: nominal and identified axes, camera and target, and where the compared model misses at ${postures.length} samples. Arrow keys turn it.`,
    caption: 'Drag, or use the arrow keys, to turn. Thin lines at the dots: from the target of the best model to the target of the compared model, exaggerated.' + (postures.length < report.counts.measured ? ` ${postures.length} of ${report.counts.measured} samples are drawn.` : ''),
    draw: drawSpace,
  });
  makeTurnable(space);
  space.svg.parentElement.classList.add('stays');
  const tell = () => {
    view.stretch = Math.round(Math.pow(10, Number(slider.value)));
    scale.textContent = `× ${view.stretch}, misses × ${figure(missStretch(), 2)}`;
  };
  slider.addEventListener('input', () => { tell(); space.redraw(); });
  choice.addEventListener('change', () => { view.model = Number(choice.value); tell(); space.redraw(); });
  tell();
  picked.listeners.push(() => space.redraw());
  showSample(pair);
}

function makeTurnable(space) {
  const svg = space.svg;
  svg.classList.add('space');
  svg.setAttribute('tabindex', '0');
  d3.select(svg).call(d3.drag().container(svg).on('drag', () => {
    view.turn += 0.008 * d3.event.dx;
    view.tilt = Math.max(-1.5, Math.min(1.5, view.tilt + 0.008 * d3.event.dy));
    space.redraw();
  }));
  svg.addEventListener('keydown', (event) => {
    const step = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1]}[event.key];
    if (!step) return;
    event.preventDefault();
    view.turn += step[0];
    view.tilt = Math.max(-1.5, Math.min(1.5, view.tilt + step[1]));
    space.redraw();
  });
}

/** The identified arm with its differences from the drawn one stretched. */
function stretched(nominal, identified) {
  return points(identified).map((p, k) => plus(point(nominal, k), minus(p, point(nominal, k)), view.stretch));
}

function drawSpace(svg) {
  const to = projector(560, 470);
  const posture = pickedPosture();
  const path = (list) => d3.line()(list.map((p) => to(p)));
  drawGround(svg, to);
  const misses = svg.append('g'), stretch = missStretch();
  for (const other of postures) {
    const centre = targetCentre(other), miss = point(other.miss, view.model).map((v) => v / 1000);
    misses.append('path').attr('class', 'miss').attr('d', path([centre, plus(centre, miss, stretch)]));
    const [x, y] = to(centre);
    misses.append('circle').attr('class', 'dot-before').attr('r', other === posture ? 5 : 2).attr('cx', x).attr('cy', y).attr('data-row', other.row);
  }
  const nominal = points(posture.nominal.points), identified = stretched(posture.nominal.points, posture.identified.points);
  const base = [0, 0, 0];
  svg.append('path').attr('class', 'arm-nominal').attr('d', path([base, ...nominal]));
  svg.append('path').attr('class', 'arm-identified').attr('d', path([base, ...identified]));
  identified.forEach((p) => svg.append('circle').attr('class', 'dot-after').attr('r', 3.4).attr('cx', to(p)[0]).attr('cy', to(p)[1]));
  const half = 0.09 * space3.radius;
  points(posture.nominal.axes).forEach((axis, k) => svg.append('path').attr('class', 'axis-nominal').attr('d', path([plus(nominal[k], axis, -half), plus(nominal[k], axis, half)])));
  const axes = stretched(posture.nominal.axes, posture.identified.axes).map((axis) => axis.map((v) => v / Math.hypot(...axis)));
  axes.forEach((axis, k) => {
    svg.append('path').attr('class', 'axis-identified').attr('d', path([plus(identified[k], axis, -half), plus(identified[k], axis, half)]));
    const [x, y] = to(plus(identified[k], axis, half * 1.25));
    svg.append('text').attr('class', 'small muted').attr('x', x).attr('y', y + 3).attr('text-anchor', 'middle').text(String(k + 1));
  });
  svg.append('path').attr('class', 'target').attr('d', path(points(posture.target)) + 'Z');
  drawCamera(svg, posture, to, path);
}

const targetCentre = (posture) => [0, 1, 2].map((k) => d3.mean(points(posture.target), (p) => p[k]));

function drawGround(svg, to) {
  const size = 0.4 * space3.radius, step = size / 4;
  for (let k = -4; k <= 4; ++k) {
    for (const line of [[[k * step, -size, 0], [k * step, size, 0]], [[-size, k * step, 0], [size, k * step, 0]]]) {
      svg.append('path').attr('class', 'ground').attr('d', d3.line()(line.map((p) => to(p))));
    }
  }
}

function drawCamera(svg, posture, to, path) {
  const [origin, ...ends] = cameraEnds(posture, 0.2 * space3.radius);
  svg.append('path').attr('class', 'camera').attr('d', path(ends) + 'Z');
  for (const end of ends) svg.append('path').attr('class', 'camera').attr('d', path([origin, end]));
  const [u, v] = to(origin);
  svg.append('text').attr('class', 'small muted').attr('x', u).attr('y', v - 10).attr('text-anchor', 'middle').text(report.pixels ? 'camera' : 'instrument');
}
