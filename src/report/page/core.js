'use strict';
// The data of a report, and words for its quantities.

const report = JSON.parse(document.getElementById('data').textContent);
const pictures = JSON.parse(document.getElementById('pictures').textContent);
const diagnosis = report.diagnosis;
const identification = report.identification;
const samples = report.samples;
const lengthUnit = report.pixels ? 'px' : 'mm';
/** Seconds since 1970 are told from the first sample on. */
const firstStamp = (() => {
  const first = samples.reduce((least, sample) => sample.stamp < least ? sample.stamp : least, Infinity);
  return isFinite(first) && first > 1e6 ? first : 0;
})();

/** The unit that a person wants for a quantity of this size, and the factor to it. */
function personal(value, unit) {
  const size = Math.abs(value);
  if (unit === 'rad') return size >= 1e-4 ? {factor: 1e3, unit: 'mrad'} : {factor: 1e6, unit: 'µrad'};
  if (unit === 'm') return size >= 1e-4 ? {factor: 1e3, unit: 'mm'} : {factor: 1e6, unit: 'µm'};
  if (unit === 'rad/(N m)') return {factor: 1e6, unit: 'µrad/(N m)'};
  return {factor: 1, unit};
}

function quantity(value, unit) {
  const {factor, unit: shown} = personal(value, unit);
  return figure(value * factor) + (shown ? ' ' + shown : '');
}

const length = (value) => figure(value) + ' ' + lengthUnit;

/** Probabilities never claim that there is no doubt. */
function sureness(probability) {
  if (probability >= 0.999) return '≥ 99.9 %';
  if (probability >= 0.99) return Math.floor(1000 * probability) / 10 + ' %';  // two digits would round to no doubt
  if (probability < 0.001) return '< 0.1 %';
  return figure(100 * probability, probability >= 0.1 ? 2 : 1) + ' %';
}

/** Bounds of most values: single wild ones do not squeeze all others. */
function usualRange(values, {symmetric = false, tail = 0.01} = {}) {
  const sorted = values.filter((v) => v !== null && isFinite(v)).sort(d3.ascending);
  if (sorted.length === 0) return [-1, 1];
  let low = d3.quantile(sorted, tail), high = d3.quantile(sorted, 1 - tail);
  if (symmetric) high = Math.max(Math.abs(low), Math.abs(high), 1e-12), low = -high;
  const margin = 0.08 * (high - low) || 0.1 * Math.abs(high) || 1;
  return [low - margin, high + margin];
}

/** Every so many-th, so that at most `most` remain. */
function thin(list, most) {
  const step = Math.ceil(list.length / most);
  return step <= 1 ? list : list.filter((_, k) => k % step === 0);
}

const sizeBefore = (sample) => sample.sizes[report.model_before];
const sizeAfter = (sample) => sample.sizes[report.model_after];
const modelName = (k) => report.models[k];

/** Which sample is picked; charts that show it are told. */
const picked = {row: samples.reduce((worst, sample, row) => sizeAfter(sample) > sizeAfter(samples[worst]) ? row : worst, 0), listeners: []};
function pick(row) {
  picked.row = Math.max(0, Math.min(samples.length - 1, row));
  for (const listener of picked.listeners) listener();
}
document.addEventListener('click', (event) => {
  const target = event.target instanceof Element ? event.target.closest('[data-row]') : null;
  if (target) pick(Number(target.dataset.row));
});
