// Fills the page of a run's report from the data in it.
import { byId } from './dom.js';
import { readData } from './data.js';
import { buildGallery } from './gallery.js';
import { buildViewer } from './panel.js';
import { buildAdvice, buildConvergence, buildHeader, buildLights, buildReasons, buildRun } from './sections.js';

// Dark or light as the system says, until the reader chooses.
function themeButton() {
  const root = document.documentElement, button = byId('theme');
  const dark = () => (root.dataset.theme || (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light')) === 'dark';
  const label = () => (button.textContent = dark() ? 'Light' : 'Dark');
  button.addEventListener('click', () => {
    root.dataset.theme = dark() ? 'light' : 'dark';
    label();
  });
  label();
}

const data = readData();
themeButton();
buildHeader(data);
buildAdvice(data);
buildLights(data);
buildConvergence(data);
buildReasons(data);
buildRun(data);
const viewer = buildViewer(data);
buildGallery(data, viewer);
document.documentElement.dataset.ready = 'true';
