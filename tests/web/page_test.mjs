// SPDX-License-Identifier: Apache-2.0
// The live page as its users have it: kinemapd, a wearer who walks, and Chromium.
import assert from "node:assert/strict";
import { createSocket } from "node:dgram";
import { after, before, test } from "node:test";
import axe from "axe-core";
import { Daemon, launchBrowser } from "./stage.mjs";

const kDesktop = { width: 1200, height: 800 };
const kPhone = { width: 390, height: 844 };
const kWait = 60000;

let browser;
before(async () => (browser = await launchBrowser()));
after(async () => {
  await browser?.close();
  await (await walked)?.remove();
});

/** Opens the page; `complaints` holds what the console and the Content-Security-Policy had to say against it. */
async function open(daemon, { viewport = kDesktop, hash = "#plan", from = browser, ...options } = {}) {
  const context = await from.newContext({ viewport, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(kWait);
  const complaints = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(error.message));
  await page.addInitScript(() => {
    addEventListener("securitypolicyviolation", (event) => console.error(`CSP: ${event.violatedDirective} ${event.blockedURI}`));
  });
  await page.goto(daemon.url + hash);
  return { page, complaints, close: () => context.close() };
}

async function withDaemon(run) {
  const daemon = await Daemon.start();
  try {
    await run(daemon);
  } finally {
    await daemon.remove();
  }
}

/** The daemon of a wearer who has been round a room, for tests that only look. */
let walked;
async function mapped() {
  walked ??= Daemon.start().then(async (daemon) => {
    await daemon.walk("--seed", "3", "--rooms", "1", "--speed", "20").done;
    await daemon.settled();
    return daemon;
  });
  return walked;
}

const until = async (condition, what) => {
  for (const end = Date.now() + kWait; Date.now() < end; await new Promise((resolve) => setTimeout(resolve, 100)))
    if (await condition()) return;
  assert.fail(`waited in vain for: ${what}`);
};
const overflow = (page) => page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
const listed = (page) => page.locator("button.item").count();

test("without a suit the page says so, and what to do", () =>
  withDaemon(async (daemon) => {
    const { page, complaints } = await open(daemon, { hash: "" });
    await page.locator(".notice", { hasText: "No suit yet" }).waitFor();
    assert.match(await page.locator(".notice").innerText(), new RegExp(`port ${daemon.suitPort}`));
    await page.locator("canvas").waitFor();
    assert.deepEqual(complaints, []);
  }));

test("who has no token is asked for it once, and a link of `kinemap pair` brings it", async () => {
  const token = "viewer-0123456789abcdef";
  const daemon = await Daemon.start({ token });
  try {
    const { page, complaints, close } = await open(daemon, { hash: "" });
    const prompt = page.getByRole("dialog", { name: "Token" });
    await prompt.waitFor();
    await prompt.getByLabel("Token").fill("wrong-0123456789abcdef");
    await prompt.getByRole("button", { name: "Show the map" }).click();
    await prompt.getByRole("alert").waitFor();
    await prompt.getByLabel("Token").fill(token);
    await prompt.getByRole("button", { name: "Show the map" }).click();
    await page.locator(".notice", { hasText: "No suit yet" }).waitFor();
    assert.equal(await prompt.count(), 0);
    await page.reload(); // kept
    await page.locator(".notice", { hasText: "No suit yet" }).waitFor();
    // A file, for which a plain link would show no token.
    await page.getByRole("tab", { name: "Files" }).click();
    const [saved] = await Promise.all([page.waitForEvent("download"), page.getByRole("link", { name: "map.json" }).click()]);
    assert.equal(saved.suggestedFilename(), "map.json");
    assert.deepEqual(complaints.filter((text) => !/401|WebSocket/.test(text)), []);
    await close();

    const linked = await open(daemon, { hash: `#token=${token}` });
    await linked.page.locator(".notice", { hasText: "No suit yet" }).waitFor();
    assert.equal(await linked.page.evaluate(() => location.hash), "");
    await linked.close();
  } finally {
    await daemon.remove();
  }
});

test("nothing is loaded from elsewhere, and no inline script may run", () =>
  withDaemon(async (daemon) => {
    const policy = (await fetch(daemon.url)).headers.get("content-security-policy");
    assert.match(policy, /default-src 'self'/);
    assert.doesNotMatch(policy, /unsafe|\*|https?:/);
    const { page } = await open(daemon);
    const ran = await page.evaluate(() => {
      const script = document.createElement("script");
      script.textContent = "window.inlineRan = true";
      document.body.append(script);
      return window.inlineRan === true;
    });
    assert.equal(ran, false);
  }));

test("the map grows while the wearer walks", () =>
  withDaemon(async (daemon) => {
    const { page, complaints } = await open(daemon);
    const walk = daemon.walk("--seed", "3", "--rooms", "1", "--speed", "12");
    const counts = new Set();
    const places = new Set();
    let done = false;
    walk.done.then(() => (done = true));
    await until(async () => {
      counts.add(await listed(page));
      const wearer = page.locator(".wearer circle");
      if (await wearer.isVisible()) places.add(await wearer.getAttribute("transform"));
      return done;
    }, "the end of the walk");
    assert.ok(counts.size >= 4, `the list showed ${[...counts]} objects`);
    assert.ok(places.size >= 10, `the wearer was seen at ${places.size} places`);
    // The solver may be behind: until the map rests.
    const { map, suit } = await daemon.settled();
    assert.ok(map.rooms.length > 0 && map.objects.length > 4, `a room: ${JSON.stringify([map.graph, suit.stream, suit.socket])}`);
    await until(async () => (await listed(page)) === map.objects.length, "all objects in the list");
    const room = page.locator(".name-room", { hasText: `Room ${map.rooms[0].id}` });
    await room.waitFor();
    assert.match(await room.textContent(), new RegExp(`${map.rooms[0].area.toFixed(1)} m²`));
    await page.getByText("Suit silent").first().waitFor();
    assert.equal((await page.locator(".wearer .bones").getAttribute("d")).match(/M/g).length, 14, "the skeleton");
    const { poses } = await daemon.get("api/v1/trajectory");
    for (const path of [".track:not(.raw)", ".track.raw"])
      await until(async () => (await page.locator(path).getAttribute("points")).split(" ").length === poses.length, `all of ${path}`);
    assert.deepEqual(complaints, []);
  }));

test("an object is chosen and left by keyboard alone", async () => {
  const daemon = await mapped();
  const { page, complaints } = await open(daemon);
  const table = (await daemon.get("api/v1/objects?type=table")).objects[0];
  await page.locator("button.item").first().waitFor();
  const focused = () => page.evaluate(() => document.activeElement?.getAttribute("data-object"));
  for (let i = 0; i < 40 && (await focused()) === null; ++i) await page.keyboard.press("Tab");
  assert.equal(await focused(), String(table.id)); // tables stand first
  await page.keyboard.press("ArrowDown");
  assert.notEqual(await focused(), String(table.id));
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("Enter");
  const detail = page.locator(".detail");
  await detail.waitFor();
  const text = await detail.innerText();
  assert.match(text, new RegExp(`Table ${table.id}`));
  assert.match(text, /put things down/);
  assert.match(text, new RegExp(`${table.size[0].toFixed(2)} ± `));
  assert.equal(await page.locator(".plan .object.selected").getAttribute("data-object"), String(table.id));
  await page.keyboard.press("Escape");
  await detail.waitFor({ state: "detached" });
  await until(async () => (await focused()) === String(table.id), "the focus back in the list");
  assert.deepEqual(complaints, []);
});

test("objects are chosen by a click in the plan and in three dimensions", async () => {
  const daemon = await mapped();
  const { page, complaints } = await open(daemon);
  const chair = (await daemon.get("api/v1/objects?type=chair")).objects[0];
  await page.locator(`.plan .object[data-object="${chair.id}"]`).click();
  await page.locator(".detail h2", { hasText: `Seat ${chair.id}` }).waitFor();
  await page.getByRole("button", { name: "Close (Esc)" }).click();

  await page.getByRole("button", { name: "3-D" }).click();
  const canvas = page.locator("canvas");
  await canvas.waitFor();
  await page.locator(".label-room").first().waitFor();
  const { x, y, width, height } = await canvas.boundingBox();
  // Somewhere round the middle of the room there is something.
  for (let i = 0; i < 25 && !(await page.locator(".detail").isVisible()); ++i)
    await page.mouse.click(x + width * (0.3 + 0.1 * (i % 5)), y + height * (0.3 + 0.1 * Math.floor(i / 5)));
  await page.locator(".label-selected").waitFor();
  assert.deepEqual(complaints, []);
});

test("on a phone nothing is cut off, and what is pressed is large", async () => {
  const daemon = await mapped();
  const { page, complaints } = await open(daemon, { viewport: kPhone, hasTouch: true, isMobile: true });
  await page.locator(".plan .object").first().waitFor();
  const check = async (state) => {
    assert.equal(await overflow(page), 0, `${state}: the page is wider than the screen`);
    const small = await page.evaluate(() =>
      [...document.querySelectorAll("button, a")]
        .map((element) => [element.textContent || element.ariaLabel, element.getBoundingClientRect()])
        .filter(([, box]) => box.width > 0 && box.top < innerHeight && box.height < (box.width > 300 ? 28 : 38))
        .map(([name, box]) => `${name} ${box.height} px`),
    );
    assert.deepEqual(small, [], state);
  };
  await check("closed");
  await page.getByRole("tab", { name: /Objects/ }).tap();
  await page.locator("button.item").first().tap();
  await page.locator(".detail").waitFor();
  await check("an object");
  await page.getByRole("button", { name: "Close (Esc)" }).first().tap();
  for (const name of [/Events/, /Suit/, /Files/]) {
    await page.getByRole("tab", { name }).tap();
    await check(String(name));
  }
  assert.deepEqual(complaints, []);
});

test("axe finds no barrier, in light and in dark", async () => {
  const daemon = await mapped();
  for (const colorScheme of ["light", "dark"]) {
    const { page } = await open(daemon, { colorScheme });
    const check = async (state) => {
      await page.evaluate(axe.source);
      const { violations } = await page.evaluate(() => globalThis.axe.run());
      assert.deepEqual(violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html)}`), [], `${colorScheme}, ${state}`);
    };
    await page.locator("button.item").first().waitFor();
    for (const name of [/Events/, /Suit/, /Files/, /Objects/]) {
      await page.getByRole("tab", { name }).click();
      await check(String(name));
    }
    await page.locator("button.item").first().click();
    await page.locator(".detail").waitFor();
    await check("an object");
  }
});

test("every file that the page offers is there", async () => {
  const daemon = await mapped();
  const { page } = await open(daemon);
  await page.getByRole("tab", { name: /Files/ }).click();
  const links = await page.locator(".panel a").evaluateAll((list) => list.map(({ href }) => href));
  assert.ok(links.length > 8);
  for (const link of links) assert.equal((await fetch(link)).status, 200, link);
});

test("a lost link is said at once, and comes back by itself", () =>
  withDaemon(async (daemon) => {
    await daemon.walk("--seed", "3", "--rooms", "1", "--speed", "40").done;
    const { page } = await open(daemon);
    await page.locator("button.item").first().waitFor();
    const before = await listed(page);
    await daemon.stop("SIGKILL");
    const notice = page.locator(".notice", { hasText: "Link lost" });
    await notice.waitFor();
    assert.match(await notice.innerText(), /since \d\d:\d\d:\d\d/);
    assert.equal(await listed(page), before, "the map stays");
    await daemon.run();
    await notice.waitFor({ state: "detached" });
    // The daemon that came back knows nothing, and the page says what the daemon says.
    await page.getByText("No suit yet").first().waitFor();
    await until(async () => (await listed(page)) === 0, "an empty list");
    const walk = daemon.walk("--seed", "3", "--rooms", "1", "--speed", "20");
    await until(async () => (await listed(page)) > 0, "the map growing again");
    walk.stop();
  }));

test("a daemon that hangs is noticed too", () =>
  withDaemon(async (daemon) => {
    const { page } = await open(daemon);
    await page.getByText("No suit yet").first().waitFor();
    daemon.process.kill("SIGSTOP");
    await page.locator(".notice", { hasText: "Link lost" }).waitFor();
    daemon.process.kill("SIGCONT");
    await page.locator(".notice", { hasText: "No suit yet" }).waitFor();
  }));

test("without WebGL the plan works and the page says why", async () => {
  const daemon = await mapped();
  const plain = await launchBrowser({ webgl: false });
  try {
    const { page } = await open(daemon, { hash: "", from: plain });
    await page.getByText("needs WebGL").waitFor();
    await page.locator(".plan .object").first().waitFor();
    assert.equal(await page.getByRole("button", { name: "3-D" }).isDisabled(), true);
  } finally {
    await plain.close();
  }
});

test("names from the network are text, never HTML", () =>
  withDaemon(async (daemon) => {
    const { page, complaints } = await open(daemon);
    const walk = daemon.walk("--seed", "3", "--rooms", "1", "--speed", "1");
    await page.getByText("Live").waitFor();
    const name = "<img src=x onerror=alert(1)>";
    const text = Buffer.from(`name:${name}\n`);
    const datagram = Buffer.alloc(28 + text.length);
    datagram.write("MXTP12", 0, "latin1");
    datagram.writeUInt8(0x80, 10);
    datagram.writeUInt8(1, 11);
    datagram.writeUInt16BE(4 + text.length, 22);
    datagram.writeUInt32BE(text.length, 24);
    text.copy(datagram, 28);
    const socket = createSocket("udp4");
    // Again and again, since the wearer says who he is as well.
    const speaking = setInterval(() => socket.send(datagram, daemon.suitPort, "127.0.0.1"), 100);
    await page.getByText(name).first().waitFor();
    clearInterval(speaking);
    socket.close();
    assert.equal(await page.locator("#app img").count(), 0);
    walk.stop();
    assert.deepEqual(complaints, []);
  }));

test("light, dark and still: the page follows the system and the button", () =>
  withDaemon(async (daemon) => {
    const { page } = await open(daemon, { colorScheme: "dark", reducedMotion: "reduce" });
    const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const dark = await background();
    await page.getByRole("button", { name: /Colours/ }).click();
    assert.notEqual(await background(), dark);
    await page.reload();
    assert.notEqual(await background(), dark, "the choice is kept");
  }));
