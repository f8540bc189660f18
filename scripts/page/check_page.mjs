// node check_page.mjs MODULES PAGE.html OUTPUT_DIR: see scripts/check_page.sh.
import { execFileSync } from 'node:child_process';
import { createRequire } from 'node:module';
import { mkdirSync, readFileSync, statSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { join, resolve } from 'node:path';

const [modules, pagePath, output] = process.argv.slice(2);
const require = createRequire(join(resolve(modules), 'node_modules', 'x.js'));
const puppeteer = (await import(pathToFileURL(require.resolve('puppeteer-core')))).default;
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
const address = pathToFileURL(resolve(pagePath)).href;
mkdirSync(output, { recursive: true });

const faults = [];
const check = (holds, what) => {
  console.log((holds ? 'ok    ' : 'FAULT ') + what);
  if (!holds) faults.push(what);
};

// Notes when the first map is on the screen, and when the 3D view has drawn.
const watchTimes = () => {
  window.seen = {};
  const look = () => {
    const image = document.querySelector('.map svg image');
    if (image && window.seen.map === undefined) {
      requestAnimationFrame(() => requestAnimationFrame(() => { window.seen.map = performance.now(); }));
      window.seen.map = Infinity;
    }
    if (document.querySelector('canvas[data-drawn]') && window.seen.cloud === undefined) window.seen.cloud = performance.now();
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
};

// The share of the canvas that is not background, and how many colours it has.
const lookAtCanvas = async (page) => {
  const canvas = await page.$('.cloud canvas');
  if (!canvas) return { share: 0, colors: 0 };
  const png = await canvas.screenshot({ encoding: 'base64' });
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = 'data:image/png;base64,' + data;
    await image.decode();
    const copy = new OffscreenCanvas(image.width, image.height).getContext('2d');
    copy.drawImage(image, 0, 0);
    const { data: pixels } = copy.getImageData(0, 0, image.width, image.height);
    const colors = new Set();
    let drawn = 0;
    for (let k = 0; k < pixels.length; k += 4) {
      const [r, g, b] = [pixels[k], pixels[k + 1], pixels[k + 2]];
      if (Math.abs(r - 11) + Math.abs(g - 20) + Math.abs(b - 24) > 24 && r + g + b > 6) ++drawn;
      colors.add(r >> 3 << 10 | g >> 3 << 5 | b >> 3);
    }
    return { share: 4 * drawn / pixels.length, colors: colors.size };
  }, png);
};

const violations = async (page) => {
  await page.evaluate(axe);
  const { violations: found } = await page.evaluate(() => window.axe.run(document, { resultTypes: ['violations'] }));
  return found.map((rule) => `${rule.id} (${rule.nodes.length}): ${rule.help}; ${rule.nodes[0].target} ${rule.nodes[0].failureSummary.replace(/\s+/g, ' ')}`);
};

const open = async (browser, width, height, suffix = '') => {
  const page = await browser.newPage();
  const problems = [];
  page.on('console', (message) => {
    if (['error', 'warn', 'assert'].includes(message.type())) problems.push(message.text());
  });
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('request', (request) => {
    if (!/^(file|data|blob):/.test(request.url())) problems.push('asks for ' + request.url());
  });
  await page.setOfflineMode(true);
  await page.setViewport({ width, height, isMobile: width < 500, hasTouch: width < 500 });
  await page.evaluateOnNewDocument(watchTimes);
  await page.goto(address + suffix, { waitUntil: 'load' });
  return { page, problems };
};

const checkWidth = async (browser, name, width, height) => {
  const { page, problems } = await open(browser, width, height);
  await page.evaluate(() => document.querySelector('.cloud canvas')?.scrollIntoView());
  await page.waitForFunction(() => document.querySelector('canvas[data-drawn]'), { timeout: 30000 }).catch(() => {});
  const seen = await page.evaluate(() => ({ ...window.seen, width: document.documentElement.scrollWidth }));
  check(seen.map < 1000, `${name}: first map after ${Math.round(seen.map)} ms`);
  check(seen.cloud < 3000, `${name}: all, with the 3D view, after ${Math.round(seen.cloud)} ms`);
  check(seen.width <= width, `${name}: ${seen.width} pixels wide, the window ${width}`);
  const canvas = await lookAtCanvas(page);
  check(canvas.share > 0.02 && canvas.colors > 20, `${name}: the 3D view shows ${(100 * canvas.share).toFixed(0)} % of something in ${canvas.colors} colours`);
  await page.evaluate(() => window.scrollTo(0, 0));
  await page.screenshot({ path: join(output, name + '.png') });
  await page.screenshot({ path: join(output, name + '_whole.png'), fullPage: true });
  await (await page.$('.cloud canvas'))?.screenshot({ path: join(output, name + '_3d.png') });
  for (const mode of ['plain', 'high contrast']) {
    if (mode !== 'plain') await page.click('#contrast');
    const found = await violations(page);
    check(found.length === 0, `${name}, ${mode}: axe finds ${found.length} violations${found.map((text) => '\n      ' + text).join('')}`);
  }
  await page.screenshot({ path: join(output, name + '_contrast.png') });
  check(problems.length === 0, `${name}: nothing on the console, no request${problems.map((text) => '\n      ' + text).join('')}`);
  await page.close();
};

const checkKeyboard = async (browser) => {
  const { page } = await open(browser, 1280, 900);
  const before = await page.$eval('.map > svg', (svg) => svg.getAttribute('viewBox'));
  await page.$eval('.map > svg', (svg) => svg.focus());
  await page.keyboard.press('+');
  const after = await page.$eval('.map > svg', (svg) => svg.getAttribute('viewBox'));
  check(before !== after, 'the map zooms by keyboard');
  if (await page.$('.map .mark')) {
    await page.$eval('.map .mark', (mark) => mark.focus());
    await page.keyboard.press('Enter');
    check(await page.evaluate(() => document.activeElement.classList.contains('gap')), 'Enter on a number leads to its entry');
  }
  await page.close();
};

const checkSlate = async (browser) => {
  const { page, problems } = await open(browser, 1000, 1200, '#slate');
  if (!(await page.$('.slate'))) {
    console.log('      no gap, so no slate');
    return;
  }
  const pdf = join(output, 'slate.pdf');
  await page.pdf({ path: pdf, preferCSSPageSize: true, printBackground: true });
  const info = execFileSync('pdfinfo', [pdf], { encoding: 'utf8' });
  check(/^Pages:\s+1$/m.test(info), 'the slate is one page');
  check(/^Page size:.*A4/m.test(info), 'the slate is A4');
  check(problems.length === 0, 'the slate: nothing on the console' + problems.join('; '));
  execFileSync('pdftoppm', ['-r', '80', '-png', '-singlefile', pdf, join(output, 'slate')]);
  await page.close();
};

// A browser of its own for each look, as somebody has who opens the page; its own beginnings, with
// an empty page, are not the page's.
const inBrowser = async (look) => {
  const browser = await puppeteer.launch({ executablePath: process.env.CHROMIUM || '/usr/bin/chromium', headless: true,
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--hide-scrollbars'] });
  await (await browser.newPage()).goto('data:text/html,<p>begin');
  await look(browser).finally(() => browser.close());
};

const bytes = statSync(pagePath).size;
check(bytes < 30 * 2 ** 20, `the page has ${(bytes / 2 ** 20).toFixed(1)} MB`);
await inBrowser((browser) => checkWidth(browser, 'desktop', 1280, 900));
await inBrowser((browser) => checkWidth(browser, 'phone', 390, 844));
await inBrowser(checkKeyboard);
await inBrowser(checkSlate);
console.log(faults.length === 0 ? 'The page is as it should be.' : `${faults.length} faults`);
process.exit(faults.length === 0 ? 0 : 1);
