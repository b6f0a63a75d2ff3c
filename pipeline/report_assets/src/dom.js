// Elements without markup in strings: whatever a text says, it is only ever a text.

const SVG = 'http://www.w3.org/2000/svg';

function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else if (name === 'style') Object.assign(node.style, value);
    else if (value === true) node.setAttribute(name, '');
    else if (value !== false && value !== undefined && value !== null) node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
  return node;
}

export const el = (tag, attributes = {}, ...children) => fill(document.createElement(tag), attributes, children);
export const svg = (tag, attributes = {}, ...children) => fill(document.createElementNS(SVG, tag), attributes, children);
export const byId = (id) => document.getElementById(id);

// A number with about `digits` significant digits, as people write it.
export function number(x, digits = 3) {
  if (!Number.isFinite(x)) return '–';
  if (x === 0) return '0';
  const size = Math.floor(Math.log10(Math.abs(x)));
  if (size < -4 || size > 6) return x.toExponential(digits - 1).replace('e', ' × 10^').replace('^+', '^');
  return x.toLocaleString('en-US', { maximumFractionDigits: Math.max(0, digits - 1 - size) });
}

export const count = (n) => n.toLocaleString('en-US');
export const percent = (x, digits = 3) => `${number(100 * x, digits)} %`;

export function seconds(s) {
  if (s < 60) return `${number(s, 2)} s`;
  const minutes = Math.floor(s / 60);
  return minutes < 60 ? `${minutes} min ${Math.round(s % 60)} s` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

// Colours of the lights, the same in the viewer, the photographs and the tables; told apart by the colour-blind too.
export const lightColors = ['#f2a900', '#2f9be0', '#d4559a', '#18a97c', '#e2622a', '#8a6de0'];
export const lightColor = (k) => lightColors[((k % lightColors.length) + lightColors.length) % lightColors.length];
