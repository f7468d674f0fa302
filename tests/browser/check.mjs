// Opens reports in headless Chromium: no error, nothing from the network,
// figures as in the JSON, values on hover and by keys, legends that toggle,
// nothing clipped, and an event's name that is only a name.
//
//     node check.mjs COULOIR CHROMIUM

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const [couloir, executablePath] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url));
const work = mkdtempSync(join(tmpdir(), "couloir-browser-"));
const HOSTILE = "</title><script>document.hacked = 1</script><img src=x onerror=alert(1)>";

// An event whose name would do something, if it were more than a name.
function hostile() {
  const folder = join(work, "event");
  cpSync(join(here, "../data/voellmy-21"), folder, { recursive: true });
  const file = join(folder, "event.toml");
  const text = readFileSync(file, "utf8");
  const name = /^name = .*$/m;
  assert.match(text, name);
  writeFileSync(file, text.replace(name, `name = ${JSON.stringify(HOSTILE)}`));
  return folder;
}

function run(verb, more) {
  const out = join(work, `${verb}-${more.length}`);
  execFileSync(couloir, [verb, ...more, "--quick", "--quiet", "--out", out]);
  const document = verb === "diagnose" ? "diagnosis.json" : "calibration.json";
  const page = join(out, "report.html");
  assert.ok(statSync(page).size < 3e6, `${page} is larger than 3 MB`);
  return { verb, page, json: JSON.parse(readFileSync(join(out, document), "utf8")) };
}

// The page with whatever goes wrong on it.
async function opened(browser, report, viewport, colorScheme) {
  const page = await browser.newPage({ viewport, colorScheme });
  const wrong = [];
  page.on("console", (m) => ["error", "warning"].includes(m.type()) && wrong.push(m.text()));
  page.on("pageerror", (error) => wrong.push(error.message));
  page.on("dialog", (dialog) => wrong.push(dialog.message()) && dialog.dismiss());
  page.on("request", (request) => request.url().startsWith("file:") || wrong.push(request.url()));
  await page.goto(`file://${report.page}`);
  return { page, wrong };
}

// Texts that a picture cuts off, and whether the page is wider than the screen.
const clipped = (page) =>
  page.evaluate(() => {
    const cut = [];
    for (const svg of document.querySelectorAll("figure svg")) {
      if (!svg.getClientRects().length) continue;
      const frame = svg.getBoundingClientRect();
      for (const text of svg.querySelectorAll("text")) {
        const box = text.getBoundingClientRect();
        const inside =
          box.left >= frame.left - 1 && box.right <= frame.right + 1 &&
          box.top >= frame.top - 1 && box.bottom <= frame.bottom + 1;
        if (!inside) cut.push(text.textContent);
      }
    }
    if (document.documentElement.scrollWidth > innerWidth) cut.push("the page");
    return cut;
  });

// The medians of the parameters' table are those of the document.
async function sameFigures(page, { json }) {
  const rows = await page.evaluate(() => {
    const heading = [...document.querySelectorAll("h2")].find((h) => h.textContent === "Parameters");
    const table = heading.nextElementSibling.querySelectorAll("tbody tr");
    return [...table].map((row) => [...row.cells].map((cell) => cell.textContent));
  });
  assert.ok(rows.length > 1);
  for (const [told, median] of rows) {
    const name = told.replace(/ \[.*\]$/, "").trim();
    const known = json.parameters[name] ?? json.parameters.find?.((p) => p.name === name);
    assert.ok(known, `${name} is not in the document`);
    const value = Number(median.replace("\u2212", "-").replaceAll("\u202f", ""));
    const exact = known.q50 ?? known.median;
    // Half of the last digit that is shown.
    const [, digits, power] = /^[^.e]*(?:\.(\d+))?(?:e(.+))?$/.exec(median.replace("\u2212", "-"));
    const half = 0.501 * 10 ** (Number((power ?? "0").replace("\u2212", "-")) - (digits ?? "").length);
    assert.ok(Math.abs(value - exact) <= half, `${name}: ${median}, ${exact}`);
  }
}

async function reads(page) {
  const panel = page.locator("#recording .panel:visible, #recording-0 .panel:visible").first();
  const output = page.locator("output.reading:visible").first();
  await panel.scrollIntoViewIfNeeded();
  const box = await panel.boundingBox();
  const svg = await panel.evaluate((p) => [p.dataset.x, p.dataset.across]);
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  const text = await output.textContent();
  const [low, high] = svg[0].split(" ").map(Number);
  const time = Number(/^time ([\d.]+) s: /.exec(text)?.[1]);
  assert.ok(Math.abs(time - (low + high) / 2) < 0.02 * (high - low), text);
  assert.match(text, /median flow [\d.]+/);
  await panel.focus();
  await page.keyboard.press("ArrowRight");
  const next = await output.textContent();
  assert.notEqual(next, text, "an arrow key reads on");
}

async function toggles(page) {
  const key = page.locator(".key[role=button]:visible", { hasText: "median flow" }).first();
  const drawn = page.locator('figure svg:visible path[data-series="median flow"]:visible');
  const before = await drawn.count();
  assert.ok(before > 0);
  await key.click();
  assert.ok((await drawn.count()) < before, "a click hides the series");
  assert.equal(await key.getAttribute("aria-pressed"), "false");
  await key.focus();
  await page.keyboard.press("Enter");
  assert.equal(await drawn.count(), before);
}

// The paper is dark where that is asked for, and what is written on it light.
async function suitsTheLight(page, colorScheme) {
  const shades = await page.evaluate(() => {
    const shade = (colour) => colour.match(/\d+/g).slice(0, 3).reduce((a, b) => a + +b, 0) / 3;
    const text = [...document.querySelectorAll("figure svg text")].find((t) => t.getClientRects().length);
    return [getComputedStyle(document.body).backgroundColor, getComputedStyle(text).fill].map(shade);
  });
  const [paper, ink] = shades;
  assert.ok(colorScheme === "dark" ? paper < 60 && ink > 120 : paper > 220 && ink < 130, String(shades));
}

const event = hostile();
const reports = [run("diagnose", []), run("calibrate", []), run("diagnose", [event]), run("calibrate", [event])];
const browser = await chromium.launch({
  executablePath,
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});
for (const report of reports) {
  for (const [width, height] of [[1280, 900], [390, 844]]) {
    for (const colorScheme of ["light", "dark"]) {
      const { page, wrong } = await opened(browser, report, { width, height }, colorScheme);
      await sameFigures(page, report);
      await reads(page);
      await toggles(page);
      await suitsTheLight(page, colorScheme);
      assert.deepEqual(await clipped(page), [], `${report.verb} at ${width}`);
      assert.equal(await page.evaluate(() => document.hacked), undefined);
      assert.deepEqual(wrong, []);
      await page.close();
    }
  }
}
await browser.close();
rmSync(work, { recursive: true });
console.log(`${reports.length} reports at 1280 and 390 px, light and dark: all holds`);
