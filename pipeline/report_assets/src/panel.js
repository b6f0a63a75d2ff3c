// The viewer with its controls: before/after, colours and their legend, what is drawn about the surface.
import { byId, count, el, number, percent } from './dom.js';
import { decodeMesh } from './data.js';
import { maps, modes } from './surface.js';
import { Viewer } from './viewer.js';

function legend(mode, range) {
  if (!mode.attribute || !range) return el('p', { class: 'about' }, mode.about);
  const stops = mode.reversed ? [...maps[mode.map]].reverse() : maps[mode.map];
  const write = (x) => (mode.percent ? percent(x, 2) : number(x, 2) + (mode.unit || ''));
  return el(
    'div', {},
    el('div', { class: 'ramp', style: { background: `linear-gradient(to right, ${stops.join(', ')})` } }),
    el('div', { class: 'ticks' }, ...[0, 0.5, 1].map((t) => el('span', {}, write(range[0] + t * (range[1] - range[0]))))),
    el('p', { class: 'about' }, mode.about),
  );
}

function choice(name, entries, chosen, onchoose) {
  return entries.map(({ id, name: label }) => [
    el('input', { type: 'radio', name, id: `${name}-${id}`, value: id, checked: id === chosen, onchange: () => onchoose(id) }),
    el('label', { for: `${name}-${id}` }, label),
  ]).flat();
}

function sizes(data) {
  const say = (name, mesh) => {
    if (!mesh) return null;
    const shown = mesh.faces < mesh.full_faces ? `, simplified from ${count(mesh.full_faces)} for this page` : '';
    return `${name}: ${count(mesh.faces)} triangles${shown}.`;
  };
  return el('p', { class: 'about' }, [say('Before', data.before), say('After', data.after)].filter((s) => s).join(' '));
}

function divider(viewer, range) {
  const handle = el('div', { class: 'divider', 'aria-hidden': 'true' }, el('span', {}, 'before'), el('span', {}, 'after'));
  const place = () => {
    handle.style.left = `${100 * viewer.divide}%`;
    handle.hidden = viewer.divide <= 0 || viewer.divide >= 1;
  };
  const set = (share) => {
    viewer.setDivide(share);
    range.value = Math.round(100 * viewer.divide);
    range.setAttribute('aria-valuetext', `${range.value} % of the picture shows the surface before`);
    place();
  };
  handle.addEventListener('pointerdown', (event) => {
    handle.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  handle.addEventListener('pointermove', (event) => {
    if (!handle.hasPointerCapture(event.pointerId)) return;
    const box = handle.parentElement.getBoundingClientRect();
    set(Math.min(Math.max((event.clientX - box.left) / box.width, 0.02), 0.98));
  });
  range.addEventListener('input', () => set(range.value / 100));
  set(range.value / 100);
  return { handle, set };
}

function comparison(data, viewer, stage) {
  if (!data.before || !data.after) return null;
  const range = el('input', { type: 'range', min: 0, max: 100, value: 50, id: 'divide', 'aria-label': 'Where before ends and after begins' });
  const { handle, set } = divider(viewer, range);
  stage.append(handle);
  const button = (label, share) => el('button', { type: 'button', onclick: () => set(share) }, label);
  return el(
    'fieldset', {}, el('legend', {}, 'Before and after'), range,
    el('div', { class: 'row' }, button('Before', 1), button('Both', 0.5), button('After', 0)),
  );
}

function colours(data, viewer) {
  const known = modes.filter((mode) => (!mode.attribute || viewer.rangeOf(mode)) && (!mode.colors || viewer.hasColors()));
  const about = el('div', { 'aria-live': 'polite' });
  const choose = (id) => {
    const mode = known.find((m) => m.id === id);
    viewer.color(mode);
    about.replaceChildren(legend(mode, mode.attribute && viewer.rangeOf(mode)));
  };
  const first = 'zebra';
  choose(first);
  return el('fieldset', {}, el('legend', {}, 'Colour'), el('div', { class: 'chips' }, ...choice('mode', known, first, choose)), about);
}

function extras(data, viewer) {
  const entries = [
    ['cameras', 'Cameras', data.scene.views.length],
    ['rays', 'Highlight rays', data.contacts.length],
    ['normals', 'Normals from highlights', data.contacts.length],
    ['lights', 'Lights', data.lights.length],
  ].filter(([, , n]) => n > 0);
  const boxes = entries.map(([id, label, n]) => {
    const on = id === 'normals';
    const box = el('input', { type: 'checkbox', id: `show-${id}`, checked: on, onchange: (e) => viewer.showOverlay(id, e.target.checked) });
    viewer.showOverlay(id, on);
    return [box, el('label', { for: box.id }, `${label} (${count(n)})`)];
  });
  return el('fieldset', {}, el('legend', {}, 'Show'), el('div', { class: 'chips' }, ...boxes.flat()));
}

function standpoint(data, viewer) {
  const select = el(
    'select', { id: 'standpoint', 'aria-label': 'Look from a camera', onchange: () => select.value !== '' && viewer.lookFrom(Number(select.value)) },
    el('option', { value: '' }, 'Look from a camera …'),
    ...data.scene.views.map((view, i) => el('option', { value: i }, view.name)),
  );
  const reset = el('button', { type: 'button', onclick: () => ((select.value = ''), viewer.reset()) }, 'Reset view');
  return el('div', { class: 'row' }, select, reset);
}

// Returns the viewer, or null where there is nothing to see or no WebGL; then the section says so.
export function buildViewer(data) {
  const stage = byId('stage'), controls = byId('controls');
  const fail = (text) => stage.replaceChildren(el('p', { class: 'empty' }, text));
  if (!data.before && !data.after) return fail('The run stopped before there was a surface to show.'), null;
  let viewer;
  try {
    viewer = new Viewer(byId('canvas'), data, decodeMesh(data.before), decodeMesh(data.after));
  } catch (error) {
    return fail(`This browser does not draw in 3D (${error.message}). Open mesh.ply in MeshLab or Blender instead.`), null;
  }
  controls.append(...[comparison(data, viewer, stage), colours(data, viewer), extras(data, viewer), standpoint(data, viewer), sizes(data)].filter((c) => c));
  return viewer;
}
