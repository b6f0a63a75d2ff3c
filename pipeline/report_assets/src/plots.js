// Small line plots as SVG.
import { el, number, svg } from './dom.js';

const kWidth = 340, kHeight = 190, kLeft = 52, kRight = 12, kTop = 12, kBottom = 34;

function ticks(low, high, log) {
  if (log) {
    const out = [];
    for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e) out.push(10 ** e);
    return out.filter((t) => t >= low * 0.999 && t <= high * 1.001);
  }
  const rough = (high - low) / 4 || 1, size = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * size).find((s) => s >= rough);
  const out = [];
  for (let t = Math.ceil(low / step) * step; t <= high + 1e-9 * step; t += step) out.push(t);
  return out;
}

// 1,000,000 would stick out to the left.
const tickLabel = (t) => (t < 1e5 ? number(t, 3) : new Intl.NumberFormat('en', { notation: 'compact' }).format(t));

function range(values, log) {
  let low = Math.min(...values), high = Math.max(...values);
  if (log) return [10 ** Math.floor(Math.log10(low)), 10 ** Math.ceil(Math.log10(high) + 1e-9)];
  low = Math.min(low, 0);
  return [low, high > low ? high * 1.05 : low + 1];
}

// series: [{name, className, values}], one value an iteration; `limit`: a line that is to be reached.
export function plot({ title, unit, series, log = false, limit }) {
  const all = series.flatMap((s) => s.values).concat(limit === undefined ? [] : [limit]).filter(Number.isFinite);
  if (!all.length) return el('figure', { class: 'plot' }, el('figcaption', {}, title), el('p', { class: 'empty' }, 'nothing measured'));
  const useLog = log && all.every((v) => v > 0);
  const [low, high] = range(all, useLog);
  const scale = useLog ? Math.log10 : (v) => v;
  const n = Math.max(...series.map((s) => s.values.length));
  const x = (i) => kLeft + ((kWidth - kLeft - kRight) * (i + 0.5)) / n;
  const y = (v) => kTop + (kHeight - kTop - kBottom) * (1 - (scale(v) - scale(low)) / (scale(high) - scale(low) || 1));
  const chart = svg('svg', { viewBox: `0 0 ${kWidth} ${kHeight}`, role: 'img', 'aria-label': `${title}: ${series.map((s) => `${s.name} from ${number(s.values[0])} to ${number(s.values.at(-1))}`).join(', ')}` });
  for (const t of ticks(low, high, useLog))
    chart.append(svg('line', { class: 'grid', x1: kLeft, x2: kWidth - kRight, y1: y(t), y2: y(t) }),
      svg('text', { class: 'tick', x: kLeft - 6, y: y(t) + 4, 'text-anchor': 'end' }, tickLabel(t)));
  const every = Math.ceil(n / 8);
  for (let i = 0; i < n; i += every) chart.append(svg('text', { class: 'tick', x: x(i), y: kHeight - kBottom + 16, 'text-anchor': 'middle' }, String(i + 1)));
  chart.append(svg('text', { class: 'tick', x: (kLeft + kWidth - kRight) / 2, y: kHeight - 4, 'text-anchor': 'middle' }, 'iteration'));
  if (limit !== undefined) chart.append(svg('line', { class: 'limit', x1: kLeft, x2: kWidth - kRight, y1: y(limit), y2: y(limit) }));
  for (const { name, className, values } of series) {
    const known = values.map((v, i) => [i, v]).filter(([, v]) => Number.isFinite(v));
    chart.append(svg('polyline', { class: `line ${className}`, points: known.map(([i, v]) => `${x(i)},${y(v)}`).join(' ') }));
    for (const [i, v] of known)
      chart.append(svg('circle', { class: `dot ${className}`, cx: x(i), cy: y(v), r: 3.5 }, svg('title', {}, `iteration ${i + 1}, ${name}: ${number(v, 4)}`)));
  }
  const key = series.length > 1
    ? el('div', { class: 'key' }, ...series.map((s) => el('span', {}, el('i', { class: s.className }), s.name)))
    : null;
  return el('figure', { class: 'plot' }, el('figcaption', {}, title, unit ? el('span', { class: 'muted' }, ` ${unit}`) : null), chart, key);
}
