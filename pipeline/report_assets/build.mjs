// Makes report_template.html of src/ and three.js: one page with its style and script, which a policy in the page
// pins by their hashes. Run by scripts/build_report_assets.
import { createHash } from 'node:crypto';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { build } from 'esbuild';

const here = new URL('.', import.meta.url).pathname;
const read = (name) => readFileSync(here + name, 'utf8');
const sha256 = (text, encoding) => createHash('sha256').update(text).digest(encoding);

// Of all that the page is made from; a test compares it, so that a stale page is noticed without node.
const sources = [...readdirSync(`${here}src`).sort().map((name) => `src/${name}`), 'build.mjs', 'package.json'];
const hash = sha256(sources.map(read).join(''), 'hex');

const { outputFiles } = await build({
  entryPoints: [`${here}src/main.js`], bundle: true, minify: true, write: false, format: 'iife', target: 'es2020',
  legalComments: 'inline', charset: 'ascii',
});
const script = outputFiles[0].text.replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--').trimEnd();
const style = read('src/report.css').replaceAll(/\s*\n\s*/g, '\n').trim();
const page = read('src/page.html')
  .replace('<html lang="en">', () => `<!-- Made by scripts/build_report_assets; do not edit. Sources ${hash} -->\n<html lang="en">`)
  .replace('STYLE-HASH', () => sha256(style, 'base64'))
  .replace('SCRIPT-HASH', () => sha256(script, 'base64'))
  .replace('STYLE-TEXT', () => style)
  .replace('SCRIPT-TEXT', () => script);
if (/[^\x00-\x7f]/.test(page)) throw new Error('the page is embedded as a C++ string: ASCII only');
writeFileSync(`${here}report_template.html`, page);
console.log(`report_template.html: ${Math.round(page.length / 1024)} KiB`);
