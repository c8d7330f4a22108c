'use strict';
// Where the tool is known how well, and what the poses cover.

function showWorkspace() {
  const node = section('workspace', 'Workspace and coverage', 'Workspace');
  if (report.uncertainty) showUncertainty(node);
  showCoverage(node);
}

function showUncertainty(node) {
  const places = report.uncertainty.flange.map((p, k) => ({x: p[0], y: p[1], z: p[2], r: Math.hypot(p[0], p[1]), mm: report.uncertainty.deviation_mm[k]})).filter((p) => p.mm !== null);
  node.append(el('h3', {}, 'How well the tool’s place is known'));
  node.append(good('even and small where you work. Where it grows, poses there would help most.'));
  const range = d3.extent(places, (p) => p.mm);
  const middle = d3.median(places, (p) => p.mm);
  node.append(el('p', {class: 'note'}, `Standard deviation of the tool’s place by the identified geometry: ${figure(range[0], 2)} to ${figure(range[1], 2)} mm, median ${figure(middle, 2)} mm, at ${places.length} postures spread over the joints’ ranges. Effects that the model does not know are not in it.` + (report.curves.length > 0 ? ' It is computed without the findings: what they explain counts as noise.' : '')));
  const low = d3.quantile(places.map((p) => p.mm).sort(d3.ascending), 0.02), high = d3.quantile(places.map((p) => p.mm).sort(d3.ascending), 0.98);
  const shade = d3.scaleLinear().domain([low, high > low ? high : low + 1e-9]).range([0.1, 1]).clamp(true);
  const pair = el('div', {class: 'pair'});
  node.append(pair);
  const own = report.arm.postures.map((p) => point(p.identified.points, p.identified.points.length / 3 - 1)).map((p) => ({x: p[0], y: p[1], z: p[2], r: Math.hypot(p[0], p[1])}));
  for (const [id, across, up, words] of [['side', 'r', 'z', 'from the side: distance from the base’s axis and height'], ['top', 'x', 'y', 'from above: x and y of base']]) {
    chart(pair, {
      id: 'uncertainty-' + id, width: 560, height: 470, words: `Standard deviation of the tool over the workspace, seen ${words}: ${figure(range[0], 2)} to ${figure(range[1], 2)} mm.`,
      caption: `Seen ${words} [m]. Rings: the poses of this capture.`,
      draw: (svg) => drawWorkspace(svg, places, own, across, up, shade, [low, high]),
    });
  }
}

function drawWorkspace(svg, places, own, across, up, shade, ends) {
  const all = places.concat(own);
  const ex = d3.extent(all, (p) => p[across]), ey = d3.extent(all, (p) => p[up]);
  const scale = Math.min(470 / (ex[1] - ex[0] || 1), 370 / (ey[1] - ey[0] || 1));
  const x = d3.scaleLinear().domain(ex).range([56, 56 + scale * (ex[1] - ex[0])]), y = d3.scaleLinear().domain(ey).range([14 + scale * (ey[1] - ey[0]), 14]);
  svg.append('g').selectAll('circle').data(places).join('circle').attr('class', 'bar').attr('r', 4.5).attr('cx', (p) => x(p[across])).attr('cy', (p) => y(p[up])).style('opacity', (p) => shade(p.mm));
  svg.append('g').selectAll('circle').data(own).join('circle').attr('fill', 'none').attr('stroke', 'currentColor').attr('stroke-width', 0.8).attr('r', 3.2).attr('cx', (p) => x(p[across])).attr('cy', (p) => y(p[up]));
  axisBelow(svg, x, y.range()[0] + 8, 6);
  axisLeft(svg, y, 48, 6);
  const top = y.range()[0] + 44;
  d3.range(6).forEach((k) => svg.append('rect').attr('class', 'bar').attr('x', 56 + 26 * k).attr('y', top).attr('width', 24).attr('height', 10).style('opacity', 0.1 + 0.18 * k));
  svg.append('text').attr('class', 'small muted').attr('x', 56 + 26 * 6 + 10).attr('y', top + 9).text(`${figure(ends[0], 2)} to ${figure(ends[1], 2)} mm`);
}

function showCoverage(node) {
  node.append(el('h3', {}, 'What the poses cover'));
  node.append(good('every joint’s readings spread over its range, and corners in all parts of the picture, its edges too.'));
  const pair = el('div', {class: 'pair'});
  node.append(pair);
  const joints = report.arm.joints;
  chart(pair, {
    id: 'coverage-joints', width: 560, height: 30 + 44 * joints.length, words: 'Readings of each joint: ' + joints.map((joint, k) => {
      const [low, high] = d3.extent(samples, (s) => s.q[k] * driverFactor('q' + (k + 1)));
      return `${joint.name} ${figure(low)} to ${figure(high)}`;
    }).join('; ') + '.',
    caption: 'Readings of every joint, one tick each, between its limits where they are stated [° or mm].', draw: (svg) => drawJoints(svg, joints),
  });
  if (!report.pixels) return;
  const columns = 12, rows = Math.max(4, Math.round(columns * report.camera.height / report.camera.width));
  const filled = lensCells(columns, rows).filter((cell) => cell.count > 0).length;
  chart(pair, {
    id: 'coverage-picture', width: 560, height: Math.round(560 * report.camera.height / report.camera.width), words: `Corners over the picture: in ${filled} of ${columns * rows} parts.`,
    caption: `Corners over the picture: in ${filled} of ${columns * rows} parts.`, draw: drawCornersSeen,
  });
}

function drawJoints(svg, joints) {
  joints.forEach((joint, k) => {
    const factor = driverFactor('q' + (k + 1)), values = samples.map((s) => s.q[k] * factor), y = 26 + 44 * k;
    const limits = joint.limits ? joint.limits.map((v) => v * factor) : d3.extent(values);
    const x = d3.scaleLinear().domain(d3.extent(values.concat(limits))).range([150, 520]);
    svg.append('text').attr('x', 138).attr('y', y + 4).attr('text-anchor', 'end').text(joint.name.length > 18 ? joint.name.slice(0, 17) + '…' : joint.name);
    svg.append('line').attr('class', 'rule').attr('x1', 150).attr('x2', 520).attr('y1', y).attr('y2', y);
    svg.append('path').attr('class', 'line-after').style('opacity', 0.55).attr('d', values.map((v) => `M${x(v).toFixed(1)},${y - 9}v18`).join(''));
    limits.forEach((v) => svg.append('line').attr('class', 'limit').attr('x1', x(v)).attr('x2', x(v)).attr('y1', y - 13).attr('y2', y + 13));
    svg.append('text').attr('class', 'small muted').attr('x', 150).attr('y', y + 24).text(figure(x.domain()[0]));
    svg.append('text').attr('class', 'small muted').attr('x', 520).attr('y', y + 24).attr('text-anchor', 'end').text(figure(x.domain()[1]) + (joint.type === 'prismatic' ? ' mm' : '°'));
  });
}

function drawCornersSeen(svg) {
  const factor = 560 / report.camera.width;
  svg.append('rect').attr('class', 'frame').attr('width', 560).attr('height', report.camera.height * factor);
  const corners = thin(cornerResiduals(report.model_before), 4000);
  svg.append('g').selectAll('circle').data(corners).join('circle').attr('class', 'dot-after').style('opacity', 0.6).attr('r', 2).attr('cx', (c) => c.u * factor).attr('cy', (c) => c.v * factor).attr('data-row', (c) => c.row);
}
