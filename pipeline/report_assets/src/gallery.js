// The photographs with their highlights; a large view in which each can be pointed at or reached by keyboard.
import { byId, count, el, lightColor, svg } from './dom.js';

const kLarge = 0.06; // of the photograph's width: such a ring is pointed at by its line, for others lie within

const accepted = (h) => h.status === 'accepted';

function unpack(photo, statuses) {
  const names = Object.keys(statuses);
  const highlights = photo.highlights.map(([x, y, a, b, turn_deg, light, status]) => ({ x, y, a, b, turn_deg, light, status: names[status] }));
  return { ...photo, highlights };
}

function describe(h, data) {
  if (accepted(h)) return `Used: ${h.light >= 0 ? `light ${h.light}, ` : ''}${data.statuses.accepted}.`;
  return `Rejected: ${data.statuses[h.status] || h.status}.`;
}

function ellipse(h, photo, data, interactive) {
  const pad = Math.max(photo.width, photo.height) * (interactive ? 0.006 : 0.012);
  const shape = svg('ellipse', {
    cx: h.x, cy: h.y, rx: h.a + pad, ry: h.b + pad, transform: `rotate(${h.turn_deg} ${h.x} ${h.y})`,
    class: accepted(h) ? 'accepted' : 'rejected',
  });
  if (accepted(h)) shape.style.stroke = lightColor(Math.max(h.light, 0));
  if (!interactive) return shape;
  const text = describe(h, data);
  const large = h.a > kLarge * photo.width ? ' large' : '';
  return svg('g', { tabindex: 0, role: 'img', 'aria-label': text, class: `spot${large}`, 'data-reason': text }, shape);
}

function picture(photo, data, interactive, shown = () => true) {
  // Those used come first, for the Tab key; the small ones last, on top of the large.
  const list = photo.highlights.filter(shown).sort((p, q) => accepted(q) - accepted(p) || q.a * q.b - p.a * p.b);
  const layer = svg('svg', { viewBox: `0 0 ${photo.width} ${photo.height}`, 'aria-hidden': interactive ? undefined : 'true' },
    ...list.map((h) => ellipse(h, photo, data, interactive)));
  const image = photo.jpeg
    ? el('img', { src: `data:image/jpeg;base64,${photo.jpeg}`, alt: '', loading: 'lazy', width: photo.width, height: photo.height })
    : el('div', { class: 'missing' }, 'photograph missing');
  const box = el('div', { class: 'photo', style: { aspectRatio: `${photo.width} / ${photo.height}` } }, image, layer);
  return { box, layer };
}

// Says why, beside the highlight that is pointed at or has the focus.
function explain(layer, note) {
  const show = (event) => {
    const spot = event.target.closest('.spot');
    note.textContent = spot ? spot.dataset.reason : note.dataset.idle;
    note.classList.toggle('active', Boolean(spot));
  };
  // A pointer at rest says nothing: what scrolls below it must not hide the reason of the one with the focus.
  let at = '';
  layer.addEventListener('pointermove', (event) => {
    const here = `${event.screenX},${event.screenY}`;
    if (here !== at) show(event);
    at = here;
  });
  for (const kind of ['focusin', 'click']) layer.addEventListener(kind, show);
}

class Lightbox {
  constructor(data, viewer) {
    this.data = data;
    this.viewer = viewer;
    this.dialog = byId('lightbox');
    this.index = 0;
    this.filter = el('select', { 'aria-label': 'Which highlights', onchange: () => this.fill() },
      el('option', { value: 'all' }, 'All'), el('option', { value: 'accepted' }, 'Used'), el('option', { value: 'rejected' }, 'Rejected'));
    this.dialog.addEventListener('keydown', (event) => {
      if (event.target === this.filter) return;
      if (event.key === 'ArrowLeft') this.step(-1);
      if (event.key === 'ArrowRight') this.step(1);
    });
    this.dialog.addEventListener('click', (event) => event.target === this.dialog && this.dialog.close());
  }

  open(index) {
    this.index = index;
    this.fill();
    this.dialog.showModal();
  }

  step(by) {
    const n = this.data.photos.length;
    this.index = (this.index + by + n) % n;
    this.fill();
  }

  fill() {
    const photo = this.data.photos[this.index];
    const wanted = this.filter.value;
    const { box, layer } = picture(photo, this.data, true, (h) => wanted === 'all' || accepted(h) === (wanted === 'accepted'));
    const idle = photo.highlights.length ? 'Point at a highlight, or press Tab, to see why it was used or rejected.' : 'No highlights were found in this photograph.';
    const note = el('p', { class: 'reason', 'aria-live': 'polite', 'data-idle': idle }, idle);
    explain(layer, note);
    const button = (label, onclick, name) => el('button', { type: 'button', onclick, 'aria-label': name }, label);
    const from3d = this.viewer && button('See in 3D', () => {
      this.dialog.close();
      this.viewer.lookFrom(photo.view);
      byId('canvas').scrollIntoView({ block: 'center' });
      byId('canvas').focus({ preventScroll: true });
    });
    this.dialog.replaceChildren(
      el('header', {}, el('h3', {}, photo.name), el('div', { class: 'row' }, this.filter, from3d || null,
        button('‹', () => this.step(-1), 'Previous photograph'), button('›', () => this.step(1), 'Next photograph'),
        button('×', () => this.dialog.close(), 'Close'))),
      box, note,
    );
  }
}

export function buildGallery(data, viewer) {
  const photos = data.photos.map((photo) => unpack(photo, data.statuses)), total = data.scene.views.length;
  const lightbox = new Lightbox({ ...data, photos }, viewer);
  const cards = photos.map((photo, i) => {
    const used = photo.highlights.filter(accepted).length;
    const text = `${count(used)} used, ${count(photo.highlights.length - used)} rejected`;
    return el('li', {}, el('button', { type: 'button', class: 'card', onclick: () => lightbox.open(i), 'aria-label': `${photo.name}: ${text}` },
      picture(photo, data, false, accepted).box, el('span', { class: 'name' }, photo.name), el('span', { class: 'muted' }, text)));
  });
  byId('gallery').replaceChildren(...cards);
  byId('gallery-note').textContent = photos.length < total
    ? `${count(photos.length)} of ${count(total)} photographs, spread evenly; the folder highlights/ has them all.`
    : `All ${count(total)} photographs, scaled down, with the highlights that were used; open one to see those rejected, and why.`;
}
