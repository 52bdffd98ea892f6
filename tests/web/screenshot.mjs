// SPDX-License-Identifier: Apache-2.0
// The picture for README.md: a wearer in the last room of three, as the live page shows it. tools/screenshot.sh calls this.
import { Daemon, launchBrowser } from "./stage.mjs";

const kFile = process.argv[2] ?? "docs/live.png";
const kSpeed = "8";
const kAt = 296; // s of stream time: the wearer draws along a wall of the third room

const daemon = await Daemon.start();
const browser = await launchBrowser();
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, colorScheme: "light" });
  await page.goto(daemon.url);
  const walk = daemon.walk("--seed", "7", "--rooms", "3", "--speed", kSpeed);
  for (let time = 0; time < kAt; ) {
    await new Promise((resolve) => setTimeout(resolve, 200));
    time = (await daemon.get("api/v1/pose")).time ?? 0;
  }
  await page.screenshot({ path: kFile, timeout: 120000 });
  walk.stop();
  console.log(`wrote ${kFile}`);
} finally {
  await browser.close();
  await daemon.remove();
}
