// The parts of the page that are words and numbers.
import { byId, count, el, lightColor, number, percent, seconds } from './dom.js';
import { plot } from './plots.js';

// On a phone each row is a card, its cells named by their column (report.css); roles keep it a table for readers.
export function table(head, rows) {
  const row = (tag, role, cells) =>
    el('tr', { role: 'row' }, ...cells.map((c, k) => el(tag, { role, 'data-column': head[k] }, el('span', {}, c))));
  return el('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'table' },
    el('table', { role: 'table' },
      el('thead', { role: 'rowgroup' }, row('th', 'columnheader', head)),
      el('tbody', { role: 'rowgroup' }, ...rows.map((cells) => row('td', 'cell', cells)))));
}

const done = (data) => data.report.outcome === 'done';

export function buildHeader(data) {
  const { report, run } = data;
  document.title = `${data.project} – Glint`;
  byId('project').textContent = data.project;
  byId('outcome').textContent = done(data) ? 'done' : 'no result';
  byId('outcome').className = `badge ${done(data) ? 'good' : 'problem'}`;
  const used = report.highlights.final_by_status.accepted || 0;
  const determined = report.lights.refined.filter((l) => l.determined).length;
  const facts = [
    ['photographs', count(report.project.views)],
    [`highlights used, of ${count(report.highlights.candidates)} bright spots`, count(used)],
    [determined === 1 ? 'light' : 'lights', count(determined)],
    ['triangles', count(report.mesh.faces)],
    ['iterations', count(report.refine.iterations.length)],
    [run.stages.some((s) => s.reused) ? 'this time; the rest was kept' : 'time', seconds(run.total_seconds)],
  ];
  byId('facts').replaceChildren(...facts.map(([name, value]) => el('div', {}, el('dt', {}, name), el('dd', {}, value))));
}

const kLevelNames = { problem: 'Problem', warning: 'Warning', note: 'Note', good: 'Good' };

export function buildAdvice(data) {
  byId('advice').replaceChildren(
    ...data.advice.map(({ level, finding, cure }) =>
      el('li', { class: level }, el('strong', {}, kLevelNames[level]), el('div', {}, el('p', {}, finding), cure ? el('p', { class: 'muted' }, cure) : null))),
  );
}

const kFrames = { world: 'fixed in the world', camera: 'moves with the camera' };

function uncertainty(light, diagonal) {
  if (light.type === 'distant') return light.sigma_deg > 0 ? `± ${number(light.sigma_deg, 2)}°` : 'taken as exact';
  return light.sigma > 0 ? `± ${percent(light.sigma / diagonal, 2)} of the object` : 'taken as exact';
}

export function buildLights(data) {
  const { lights } = data.report;
  if (!lights.refined.length) return byId('lights').replaceChildren(el('p', { class: 'empty' }, 'No light was given or found.'));
  const updates = data.report.refine.iterations.at(-1)?.bundle.lights || [];
  const rows = lights.refined.map((light, k) => {
    const vector = light.direction_to_light || light.position;
    const moved = updates[k] && updates[k].sigma > 0 ? (light.type === 'distant' ? `${number(updates[k].change, 2)}°` : percent(updates[k].change, 2)) : '–';
    return [
      el('span', { class: 'swatch' }, el('i', { style: { background: lightColor(k) } }), String(k)),
      `${light.type}, ${kFrames[light.frame]}`,
      el('code', {}, vector.map((x) => number(x, 4)).join('  ')),
      light.determined ? uncertainty(light, data.report.seed.diagonal_world) : 'not determined',
      number(Math.round(light.support), 3),
      moved,
      lights.given.length ? 'given' : light.determined ? 'found' : `not used: ${light.why}`,
    ];
  });
  byId('lights').replaceChildren(
    table(['Light', 'Kind', 'Direction or position', 'Uncertainty (1 σ)', 'Highlights', 'Last step moved it', 'Came from'], rows));
}

export function buildConvergence(data) {
  const all = data.report.refine.iterations;
  if (!all.length) return byId('plots').replaceChildren(el('p', { class: 'empty' }, 'The refinement did not start.'));
  const of = (get) => all.map(get);
  const one = (name, className, get) => ({ name, className, values: of(get) });
  const plots = [
    plot({ title: 'Motion of the contacts', unit: 'voxels, median', log: true, series: [one('motion', 'a', (i) => i.contact_motion_voxels)] }),
    plot({ title: 'Energy of the surface', log: true, series: [one('before the step', 'b', (i) => i.level_set.energy_before), one('after', 'a', (i) => i.level_set.energy_after)] }),
    plot({ title: 'Contacts on the surface', series: [one('on the surface', 'a', (i) => i.contacts_on_surface), one('rejected', 'b', (i) => i.bundle.rejected)] }),
    plot({ title: 'Misfit of chords', unit: 'standard deviations, rms', series: [one('misfit', 'a', (i) => i.bundle.chord_rms_sigmas)] }),
    plot({ title: 'Size of a voxel', unit: '% of the object', series: [one('voxel', 'a', (i) => 100 * i.voxel_rel)] }),
    plot({ title: 'Time', unit: 'seconds', series: [{ name: 'time', className: 'a', values: data.run.iteration_seconds }] }),
  ];
  byId('plots').replaceChildren(...plots);
  byId('converged').textContent = data.report.refine.converged
    ? `The contacts came to rest after ${all.length} iterations, coarse to fine.`
    : `Stopped after ${all.length} iterations, coarse to fine, before the contacts came to rest.`;
}

export function buildReasons(data) {
  const entries = Object.entries(data.report.highlights.final_by_status).sort((a, b) => b[1] - a[1]);
  if (!entries.length) return byId('reasons').replaceChildren(el('p', { class: 'empty' }, 'There are no highlights.'));
  const most = entries[0][1];
  byId('reasons').replaceChildren(...entries.map(([status, n]) =>
    el('li', { class: status === 'accepted' ? 'used' : '' }, el('span', {}, data.statuses[status]),
      el('span', { class: 'bar' }, el('i', { style: { width: `${(100 * n) / most}%` } })), el('b', {}, count(n)))));
}

function copyButton(text) {
  const button = el('button', { type: 'button', onclick: async () => {
    try {
      await navigator.clipboard.writeText(text);
      button.textContent = 'Copied';
    } catch {
      button.textContent = 'Select and copy';
    }
    setTimeout(() => (button.textContent = 'Copy'), 2000);
  } }, 'Copy');
  return button;
}

export function buildRun(data) {
  const { report, run } = data;
  byId('command-folder').textContent = run.command_folder ? `In the folder ${run.command_folder}:` : '';
  byId('command').replaceChildren(el('code', {}, run.command), copyButton(run.command));
  const longest = Math.max(...run.stages.map((s) => s.seconds), 1e-9);
  byId('times').replaceChildren(...run.stages.map((s) =>
    el('li', {}, el('span', {}, s.stage), el('span', { class: 'bar' }, el('i', { style: { width: `${(100 * s.seconds) / longest}%` } })),
      el('b', {}, s.reused ? 'kept' : seconds(s.seconds)))));
  const facts = [
    ['Glint', report.glint],
    ['With', Object.entries(report.versions).map(([name, version]) => `${name} ${version}`).join(', ')],
    ['Model', report.project.model],
    ['Photographs', report.project.images],
    ['Sparse points', `${count(report.project.points)}, of which ${count(report.project.points_on_object)} on the object`],
    ['Size of the object', `${number(report.seed.diagonal_world, 4)} units of the model (diagonal)`],
    ['Seed', report.seed.report],
    ...report.notes.map((note) => ['Note', note]),
  ].filter(([, value]) => value !== '');
  byId('versions').replaceChildren(...facts.flatMap(([name, value]) => [el('dt', {}, name), el('dd', {}, value)]));
  byId('config').textContent = data.config;
  byId('config-copy').replaceChildren(copyButton(data.config));
  byId('raw').textContent = JSON.stringify({ ...report, ...run }, null, 2);
}
