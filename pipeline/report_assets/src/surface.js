// A surface under one shader with every way to colour it.
import { BufferAttribute, BufferGeometry, DoubleSide, Mesh, ShaderMaterial, Vector3, GLSL3 } from 'three';

// Stops of the colour maps; the legend draws the same ones.
export const maps = {
  sequential: ['#352a5e', '#3f5b8c', '#2f8f8b', '#6cc070', '#f4e25c'],
  diverging: ['#1f5fb0', '#8fbde0', '#f1efea', '#eeb07a', '#b3471b'],
  curvature: ['#5b3a8e', '#b5a3d4', '#f1efea', '#a3cfa0', '#2c7a43'],
};

export const modes = [
  { id: 'plain', name: 'Plain', about: 'The surface as clay under one lamp beside you.' },
  {
    id: 'photo',
    name: 'Photographs',
    colors: true,
    about: 'The colour of the surface in the photographs, without the highlights.',
  },
  {
    id: 'zebra',
    name: 'Reflection lines',
    about: 'The mirror image of a striped room. Stripes that flow are a fair surface; a kink or a wobble is a wrong normal.',
  },
  {
    id: 'confidence',
    name: 'Confidence',
    attribute: 'confidence',
    map: 'sequential',
    about: 'How well the direction of the surface is known: 1 beneath a highlight, near 0 where it only rests on points and smoothness.',
  },
  {
    id: 'moved',
    name: 'Distance moved',
    attribute: 'moved_rel',
    map: 'diverging',
    symmetric: true,
    percent: true,
    about: 'How far the surface went from the sparse one, in per cent of the object’s size; positive is outward.',
  },
  {
    id: 'curvature',
    name: 'Curvature',
    attribute: 'curvature',
    map: 'curvature',
    symmetric: true,
    about: 'Mean curvature, in one over the object’s size: positive where it bulges, negative where it is hollow.',
  },
  {
    id: 'sigma',
    name: 'Uncertainty of normals',
    attribute: 'sigma_normal_deg',
    map: 'sequential',
    reversed: true,
    unit: '°',
    about: 'Standard deviation of the surface’s direction, in degrees.',
  },
];

const vertexShader = `
in float value;
in vec3 tint;
out vec3 vTint;
out vec3 vNormal;
out vec3 vWorld;
out float vValue;
void main() {
  vTint = tint;
  vNormal = normal;
  vWorld = position;
  vValue = value;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const fragmentShader = `
in vec3 vTint;
in vec3 vNormal;
in vec3 vWorld;
in float vValue;
out vec4 color;
uniform vec3 stops[5];
uniform vec3 up;
uniform float low, high;
uniform int mode;  // 0 plain, 1 reflection lines, 2 values, 3 colours
vec3 mapped(float t) {
  float x = 4.0 * clamp(t, 0.0, 1.0);
  int below = int(min(floor(x), 3.0));
  return mix(stops[below], stops[below + 1], x - float(below));
}
void main() {
  vec3 n = normalize(vNormal);
  vec3 toEye = normalize(cameraPosition - vWorld);
  bool back = dot(n, toEye) < 0.0 && !gl_FrontFacing;
  if (back) n = -n;
  vec3 right = normalize(vec3(viewMatrix[0][0], viewMatrix[1][0], viewMatrix[2][0]));
  vec3 above = normalize(vec3(viewMatrix[0][1], viewMatrix[1][1], viewMatrix[2][1]));
  vec3 lamp = normalize(toEye + 0.55 * above - 0.45 * right);
  float diffuse = max(dot(n, lamp), 0.0);
  float sky = 0.5 + 0.5 * dot(n, above);
  float shade = 0.34 + 0.56 * diffuse + 0.12 * sky;
  float gloss = pow(max(dot(n, normalize(lamp + toEye)), 0.0), 40.0);
  vec3 base = vec3(0.80, 0.77, 0.72);
  if (mode == 1) {
    vec3 mirrored = reflect(-toEye, n);
    float phase = 22.0 * acos(clamp(dot(mirrored, up), -0.9999, 0.9999));
    float edge = max(fwidth(phase), 1e-4);
    float stripe = smoothstep(-0.7 * edge, 0.7 * edge, sin(phase));
    stripe = mix(stripe, 0.5, smoothstep(1.5, 3.1, edge));
    base = mix(vec3(0.10, 0.12, 0.16), vec3(0.97, 0.97, 0.95), stripe);
    shade = 0.72 + 0.28 * diffuse;
    gloss = 0.0;
  } else if (mode == 2) {
    base = mapped((vValue - low) / (high - low));
    gloss *= 0.35;
  } else if (mode == 3) {
    base = vTint;
    shade = 0.82 + 0.2 * diffuse;
    gloss = 0.0;
  }
  if (back) base = mix(base, vec3(0.55, 0.25, 0.22), 0.7);
  color = vec4(base * shade + 0.16 * gloss, 1.0);
}`;

const rgb = (hex) => new Vector3(...[1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255));

export class Surface {
  constructor(mesh, up) {
    this.mesh = mesh;
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(mesh.positions, 3));
    geometry.setAttribute('normal', new BufferAttribute(mesh.normals, 3));
    geometry.setAttribute('value', new BufferAttribute(new Float32Array(mesh.positions.length / 3), 1));
    if (mesh.colors) geometry.setAttribute('tint', new BufferAttribute(mesh.colors, 3, true));
    geometry.setIndex(new BufferAttribute(mesh.faces, 1));
    this.uniforms = {
      stops: { value: maps.sequential.map(rgb) },
      up: { value: new Vector3(...up) },
      low: { value: 0 },
      high: { value: 1 },
      mode: { value: 0 },
    };
    const material = new ShaderMaterial({
      glslVersion: GLSL3, uniforms: this.uniforms, vertexShader, fragmentShader, side: DoubleSide,
    });
    this.object = new Mesh(geometry, material);
    this.object.frustumCulled = false;
  }

  // Colours by `mode` between `low` and `high`; plain where the mesh does not know the attribute.
  show(mode, low, high) {
    const values = mode.attribute && this.mesh.attributes[mode.attribute];
    this.uniforms.mode.value = mode.id === 'zebra' ? 1 : values ? 2 : mode.colors && this.mesh.colors ? 3 : 0;
    if (!values) return;
    const stops = maps[mode.map].map(rgb);
    this.uniforms.stops.value = mode.reversed ? stops.reverse() : stops;
    this.uniforms.low.value = low;
    this.uniforms.high.value = Math.max(high, low + 1e-9);
    const attribute = this.object.geometry.getAttribute('value');
    attribute.array.set(values);
    attribute.needsUpdate = true;
  }
}
