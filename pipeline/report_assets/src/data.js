// What the page is about: JSON elements with arrays in base64 (little-endian, as is every machine with a browser).

const json = (id) => JSON.parse(document.getElementById(id).textContent);

function bytes(base64) {
  const text = atob(base64);
  const out = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) out[i] = text.charCodeAt(i);
  return out;
}

const array = (Type, base64) => new Type(bytes(base64).buffer);

function positions({ min, size, positions: packed }) {
  const units = array(Uint16Array, packed);
  const out = new Float32Array(units.length);
  for (let i = 0; i < out.length; ++i) out[i] = min[i % 3] + (size[i % 3] * units[i]) / 65535;
  return out;
}

// Octahedral unit vectors.
function normals({ normals: packed }) {
  const units = array(Int16Array, packed);
  const out = new Float32Array((units.length / 2) * 3);
  for (let v = 0; v < units.length / 2; ++v) {
    let x = units[2 * v] / 32767, y = units[2 * v + 1] / 32767;
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
    const length = Math.hypot(x, y, z);
    out.set([x / length, y / length, z / length], 3 * v);
  }
  return out;
}

export function decodeMesh(mesh) {
  if (!mesh) return null;
  const attributes = {};
  for (const [name, { min, max, data }] of Object.entries(mesh.attributes))
    attributes[name] = Float32Array.from(array(Uint16Array, data), (unit) => min + ((max - min) * unit) / 65535);
  return {
    ...mesh,
    attributes,
    positions: positions(mesh.geometry),
    normals: normals(mesh.geometry),
    colors: mesh.colors && bytes(mesh.colors),
    faces: array(Uint32Array, mesh.geometry.faces),
  };
}

// The magnitude that all but `share` of the values stay below.
export function quantile(values, share) {
  const sorted = Float32Array.from(values, Math.abs).sort();
  return sorted.length ? sorted[Math.floor(share * (sorted.length - 1))] : 0;
}

export const readData = () => ({ ...json('glint-data'), run: json('glint-run') });
