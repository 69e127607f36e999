// Opens reports in headless Chromium and uses them: node check.mjs OUT REPORT.html...
// or makes a picture of one: node check.mjs --picture OUT.png REPORT.html
// Every check that fails is one line; the exit code is 1 then. Screenshots go to OUT.
import { createRequire } from "node:module";
import { mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const [out, ...reports] = process.argv.slice(2);
const sizes = { desktop: { width: 1280, height: 900 }, phone: { width: 360, height: 780 } };
const controls = "a[href], button:not(:disabled), input, select, textarea, summary, [tabindex='0']";
const args = [
  "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync",
];
let failures = 0, checks = 0;

function check(where, what, holds, found = "") {
  checks += 1;
  if (holds) return;
  failures += 1;
  console.log(`FAILED  ${where}: ${what}${found === "" ? "" : `: ${found}`}`);
}

/** Loads a report in a fresh profile, with everything that it says to the console or asks for. */
async function open(report, options) {
  const profile = mkdtempSync(join(tmpdir(), "selfneg-report-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.SELFNEG_CHROMIUM ?? "/usr/bin/chromium", headless: true, args, ...options,
  });
  const page = context.pages()[0] ?? await context.newPage();
  const url = pathToFileURL(resolve(report)).href;
  const complaints = [], requests = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) complaints.push(message.text());
  });
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(url);
  const close = async () => {
    await context.close();
    rmSync(profile, { recursive: true, force: true });
  };
  return { page, url, complaints, requests, close };
}

/** Presses Tab through the whole page; gives the controls that were never focused. */
async function unreached(page) {
  await page.evaluate((controls) => {
    window.scrollTo(0, 0);
    document.activeElement?.blur();
    const visible = (element) => element.getClientRects().length > 0;
    [...document.querySelectorAll(controls)].filter(visible)
      .forEach((element, nth) => { element.dataset.control = String(nth); });
  }, controls);
  const all = await page.locator("[data-control]").count();
  const reached = new Set(), unmarked = [];
  for (let presses = 0; presses < all + 5 && reached.size < all; presses += 1) {
    await page.keyboard.press("Tab");
    const focused = await page.evaluate(() => {
      const { dataset, tagName, textContent } = document.activeElement;
      const { outlineStyle, outlineWidth } = getComputedStyle(document.activeElement);
      return { control: dataset.control, name: `${tagName} ${textContent.trim().slice(0, 30)}`,
        marked: outlineStyle !== "none" && parseFloat(outlineWidth) >= 2 };
    });
    if (focused.control === undefined) continue;
    reached.add(focused.control);
    if (!focused.marked) unmarked.push(focused.name);
  }
  const missed = await page.evaluate((reached) => [...document.querySelectorAll("[data-control]")]
    .filter(({ dataset }) => !reached.includes(dataset.control))
    .map(({ tagName, textContent }) => `${tagName} ${textContent.trim().slice(0, 30)}`), [...reached]);
  return { all, missed, unmarked };
}

const clock = (page) => page.locator("#clock").textContent();
const robotAt = (page) => page.evaluate(() =>
  [...document.querySelectorAll(".robot")].map((robot) => robot.getAttribute("transform")).join());

async function byKeyboard(where, page) {
  const slider = page.locator("#time");
  await slider.focus();
  await page.keyboard.press("Home");
  check(where, "Home moves the slider to the begin", await clock(page) === "00:00", await clock(page));
  const began = await robotAt(page);
  for (let press = 0; press < 10; press += 1) await page.keyboard.press("ArrowRight");
  check(where, "ten arrows are ten seconds", await clock(page) === "00:10", await clock(page));
  if (began !== "") check(where, "the robot has moved with the slider", await robotAt(page) !== began, began);
  const spoken = await slider.getAttribute("aria-valuetext");
  check(where, "the slider says its time", spoken.startsWith("00:10"), spoken);

  await page.locator("#play").focus();
  await page.keyboard.press("Enter");
  check(where, "Enter plays", await page.locator("#play").textContent() === "Pause");
  await page.waitForFunction(() => document.getElementById("clock").textContent >= "00:13", null, { timeout: 10000 })
    .catch(() => {});
  await page.keyboard.press("Space");
  check(where, "Space pauses", await page.locator("#play").textContent() === "Play");
  const played = await clock(page);
  check(where, "playing moves on", played > "00:10", played);
  await page.waitForTimeout(300);
  check(where, "pausing stops", await clock(page) === played, await clock(page));
}

async function clickThrough(where, page) {
  const moments = page.locator(".timeline .moment");
  const number = await moments.count();
  check(where, "the timeline has moments", number > 3, number);
  for (let nth = 0; nth < number; nth += 1) {
    const button = moments.nth(nth).locator("button.seek");
    await button.click();
    const [wanted, shown] = [await button.textContent(), await clock(page)];
    check(where, "a moment's button moves the map", wanted === shown, `${wanted}, shown ${shown}`);
    const current = await moments.nth(nth).getAttribute("aria-current");
    check(where, "the moment shown is marked", current === "time", wanted);
  }
  check(where, "one moment is marked", await page.locator(".moment[aria-current]").count() === 1);
  const said = await page.locator("#now").textContent();
  const last = await moments.last().locator("p").first().textContent();
  check(where, "what is shown is said", said.includes(last.trim()), said);

  check(where, "there is a decisive round", await page.locator("tr[aria-current='true']").count() > 0);
  const links = page.locator(".timeline .to-decision");
  check(where, "the timeline leads to a decision", await links.count() > 0);
  for (let nth = 0; nth < await links.count(); nth += 1) {
    await links.nth(nth).click();
    const target = (await links.nth(nth).getAttribute("href")).slice(1);
    const focused = await page.evaluate(() => document.activeElement.id);
    check(where, "the decision is focused", focused === target, focused);
    const article = page.locator(`#${target}`);
    const agreements = await article.locator(".ending b", { hasText: "Agreement for" }).count();
    const decisive = article.locator("tr[aria-current='true']");
    check(where, "every agreement has its decisive round", await decisive.count() === agreements,
      `${await decisive.count()} of ${agreements}`);
    for (let round = 0; round < Math.min(agreements, await decisive.count()); round += 1) {
      const text = await decisive.nth(round).textContent();
      check(where, "the decisive round says so, and that it was accepted",
        text.includes("decisive") && text.includes("accepts"), text);
    }
  }
}

async function accessible(where, page) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  for (const { id, impact, nodes } of violations) {
    const found = `${id}: ${nodes.slice(0, 3).map(({ html }) => html.slice(0, 140)).join(" | ")}`;
    check(where, "axe finds nothing serious", !["serious", "critical"].includes(impact), `${impact} ${found}`);
    if (!["serious", "critical"].includes(impact)) console.log(`note    ${where}: axe: ${impact} ${found}`);
  }
  check(where, "axe ran", Array.isArray(violations));
}

async function inOneLook(report, size, colorScheme) {
  const where = `${basename(report, ".html")} ${size} ${colorScheme}`;
  const opened = await open(report, { viewport: sizes[size], colorScheme });
  const { page, url, complaints, requests } = opened;
  await page.screenshot({ path: join(out, `${where.replaceAll(" ", "-")}.png`), fullPage: true });
  await page.screenshot({ path: join(out, `${where.replaceAll(" ", "-")}-first.png`) });
  await accessible(where, page);
  const wide = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
  check(where, "nothing is wider than the screen", wide[0] <= wide[1], wide.join(" > "));
  const { all, missed, unmarked } = await unreached(page);
  check(where, "there are controls", all > 5, all);
  check(where, "Tab reaches every control", missed.length === 0, missed.join(", "));
  check(where, "the focus can be seen", unmarked.length === 0, unmarked.join(", "));
  await byKeyboard(where, page);
  await clickThrough(where, page);
  check(where, "nothing is complained of in the console", complaints.length === 0, complaints.join(" | "));
  check(where, "nothing but the file is asked for", requests.length === 1 && requests[0] === url, requests.join(", "));
  await opened.close();
}

async function withoutScript(report) {
  const where = `${basename(report, ".html")} without script`;
  const opened = await open(report, { viewport: sizes.desktop, javaScriptEnabled: false });
  const { page, complaints } = opened;
  for (const section of ["answers", "run", "decisions", "about"]) {
    check(where, `${section} can be read`, await page.locator(`#${section} h2`).isVisible());
  }
  check(where, "the rounds can be read", await page.locator("#decisions table tbody tr").first().isVisible());
  check(where, "controls that do nothing are not offered", !await page.locator("#player").isVisible());
  check(where, "no button can be pressed", await page.locator("button:enabled:visible").count() === 0);
  check(where, "nothing is complained of in the console", complaints.length === 0, complaints.join(" | "));
  await opened.close();
}

async function withoutMotion(report) {
  const where = `${basename(report, ".html")} without motion`;
  const opened = await open(report, { viewport: sizes.desktop, reducedMotion: "reduce" });
  const { page } = opened;
  const opening = await clock(page);
  await page.locator("#play").click();
  const [next, there] = [await clock(page), await robotAt(page)];
  check(where, "playing goes on to the next moment", next > opening, next);
  await page.waitForTimeout(500);
  check(where, "nothing moves in between", await clock(page) === next && await robotAt(page) === there);
  await opened.close();
}

if (out === "--picture") {
  const [picture, report] = reports;
  const { page, close } = await open(report, { viewport: { width: 1040, height: 1140 }, colorScheme: "light" });
  await page.screenshot({ path: picture });
  await close();
  process.exit(0);
}
mkdirSync(out, { recursive: true });
for (const report of reports) {
  // Each in a browser of its own, most of the time waiting for it.
  const looks = Object.keys(sizes).flatMap((size) => ["light", "dark"].map((scheme) => [size, scheme]));
  await Promise.all(looks.map(([size, scheme]) => inOneLook(report, size, scheme)));
  await Promise.all([withoutScript(report), withoutMotion(report)]);
}
console.log(`${checks} checks of ${reports.length} reports in Chromium, ${failures} failed`);
process.exit(failures === 0 && reports.length > 0 ? 0 : 1);
