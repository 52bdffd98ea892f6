// SPDX-License-Identifier: Apache-2.0
// What tests and the screenshot share: a daemon of one's own, a simulated wearer, and Debian's Chromium.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { existsSync } from "node:fs";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { createSocket } from "node:dgram";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import { settled } from "../settled.mjs";

const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const build = process.env.KINEMAP_BUILD ?? join(root, "build/release");
export const kinemapd = join(build, "daemon/kinemapd");
export const kinemap = join(build, "tools/kinemap/kinemap");

export const chromiumPath = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);

async function freeTcpPort() {
  const server = createServer().listen(0, "127.0.0.1");
  await once(server, "listening");
  const { port } = server.address();
  server.close();
  await once(server, "close");
  return port;
}

async function freeUdpPort() {
  const socket = createSocket("udp4").bind(0, "127.0.0.1");
  await once(socket, "listening");
  const { port } = socket.address();
  socket.close();
  return port;
}

/** kinemapd on free ports, which stay the same when it is stopped and started again. */
export class Daemon {
  /** With a `token` the daemon wants it of everybody. */
  static async start({ token } = {}) {
    const daemon = new Daemon();
    daemon.folder = await mkdtemp(join(tmpdir(), "kinemap-web-"));
    daemon.suitPort = await freeUdpPort();
    daemon.apiPort = await freeTcpPort();
    daemon.url = `http://127.0.0.1:${daemon.apiPort}/`;
    const tokens = join(daemon.folder, "tokens");
    const config = {
      suit: { address: "127.0.0.1", port: daemon.suitPort },
      api: { port: daemon.apiPort, ...(token ? { auth: "always", tokens } : {}) },
    };
    if (token) await writeFile(tokens, `read ${token}\n`, { mode: 0o600 });
    await writeFile(join(daemon.folder, "config.json"), JSON.stringify(config));
    await daemon.run();
    return daemon;
  }

  async run() {
    this.process = spawn(kinemapd, ["--config", join(this.folder, "config.json")], { stdio: "ignore" });
    for (;;) {
      if (this.process.exitCode !== null) throw new Error(`kinemapd did not start: exit code ${this.process.exitCode}`);
      const alive = await fetch(this.url).then((answer) => answer.ok).catch(() => false);
      if (alive) return;
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  }

  async stop(signal = "SIGTERM") {
    if (this.process.exitCode !== null || this.process.signalCode !== null) return;
    this.process.kill(signal);
    await once(this.process, "exit");
  }

  async remove() {
    await this.stop("SIGKILL");
    await rm(this.folder, { recursive: true, force: true });
  }

  /** A wearer who walks; `done` when all is sent. */
  walk(...options) {
    const sim = spawn(kinemap, ["sim", "--udp", `127.0.0.1:${this.suitPort}`, ...options], { stdio: ["ignore", "ignore", "inherit"] });
    return { done: once(sim, "exit"), stop: () => sim.kill("SIGKILL") };
  }

  /** Map and suit's state once the suit is silent and no event waits for the solver. */
  async settled() {
    await settled(this.url);
    return { map: await this.get("api/v1/map"), suit: (await this.get("api/v1/status")).suit };
  }

  async get(path) {
    return (await fetch(this.url + path)).json();
  }
}

/** Chromium without a screen; WebGL comes from SwiftShader, in software. */
export function launchBrowser({ webgl = true } = {}) {
  return chromium.launch({
    executablePath: chromiumPath,
    args: [
      "--no-sandbox", // CI is root
      ...(webgl ? ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"] : ["--disable-gpu", "--disable-3d-apis"]),
    ],
  });
}
