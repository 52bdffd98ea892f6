// SPDX-License-Identifier: Apache-2.0
// What the tests share: a kinemapd on ports of its own, and Foxglove's client and schemas.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";

import Ajv from "ajv/dist/2020.js";
import { WebSocket } from "ws";

const require = createRequire(import.meta.url); // Foxglove's packages are CommonJS
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const schemas = require("@foxglove/schemas/jsonschema");

const programs = { kinemap: process.env.KINEMAP, kinemapd: process.env.KINEMAPD };
for (const [name, path] of Object.entries(programs))
  if (!path) throw new Error(`${name.toUpperCase()} must be the path of the program ${name}; ctest sets it`);

const children = new Set();
process.on("exit", () => children.forEach((child) => child.kill("SIGKILL")));

function start(program, ...args) {
  const child = spawn(programs[program], args, { stdio: ["ignore", "pipe", "pipe"] });
  children.add(child);
  child.done = once(child, "exit").then(([code]) => {
    children.delete(child);
    return code;
  });
  return child;
}

/** Runs a program to its end; throws with its output when it fails. */
export async function run(program, ...args) {
  const child = start(program, ...args);
  let output = "";
  child.stdout.on("data", (data) => (output += data));
  child.stderr.on("data", (data) => (output += data));
  if ((await child.done) !== 0) throw new Error(`${program} ${args.join(" ")}: ${output}`);
}

/** A kinemapd on ports that the system chose. */
export class Daemon {
  static async start() {
    const daemon = new Daemon();
    daemon.process = start("kinemapd", "--port", "0", "--suit-port", "0");
    let output = "";
    const ready = new Promise((resolve) => {
      for (const stream of [daemon.process.stdout, daemon.process.stderr])
        stream.on("data", (data) => {
          output += data;
          const ports = /port (\d+), map at http:\/\/127\.0\.0\.1:(\d+)\//.exec(output);
          if (ports) resolve(ports.slice(1).map(Number));
        });
    });
    const ports = await Promise.race([ready, daemon.process.done]);
    if (!Array.isArray(ports)) throw new Error(`kinemapd did not start: ${output}`);
    [daemon.suitPort, daemon.port] = ports;
    return daemon;
  }

  /** Lets a simulated wearer walk; resolves when the walk is over. */
  walk(...args) {
    return run("kinemap", "sim", "--udp", `127.0.0.1:${this.suitPort}`, ...args);
  }

  async get(path) {
    const answer = await fetch(`http://127.0.0.1:${this.port}${path}`);
    return answer.json();
  }

  async stop() {
    this.process.kill("SIGTERM");
    await this.process.done;
  }
}

/** Foxglove's own client, connected. `opening` collects what comes at first. */
export async function connect(daemon, subprotocol = FoxgloveClient.SUPPORTED_SUBPROTOCOL) {
  const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/`, [subprotocol]);
  const client = new FoxgloveClient({ ws: socket });
  const opening = await new Promise((resolve, reject) => {
    const seen = {};
    client.on("error", reject);
    client.on("close", () => reject(new Error("the connection was closed")));
    client.on("serverInfo", (info) => (seen.serverInfo = info));
    client.on("advertise", (channels) => (seen.channels = channels));
    client.on("advertiseServices", (services) => resolve({ ...seen, services }));
  });
  return { client, socket, ...opening, channel: (topic) => opening.channels.find((c) => c.topic === topic) };
}

/** The next event of that name for which `wanted` holds. */
export function next(client, name, wanted = () => true) {
  return new Promise((resolve) => {
    const listener = (event) => {
      if (!wanted(event)) return;
      client.off(name, listener);
      resolve(event);
    };
    client.on(name, listener);
  });
}

const ajv = new Ajv({ strict: false });
const compiled = new Map();

/** Throws when the message does not fit Foxglove's schema of that name ("foxglove.Log"). */
export function checkSchema(name, message) {
  if (!compiled.has(name)) compiled.set(name, ajv.compile(schemas[name.replace("foxglove.", "")]));
  const validate = compiled.get(name);
  if (!validate(message)) throw new Error(`${name}: ${ajv.errorsText(validate.errors)}`);
}

/** Throws when the message does not fit the schema that was sent along. */
export function checkOwnSchema(text, message) {
  if (!compiled.has(text)) compiled.set(text, ajv.compile(JSON.parse(text)));
  const validate = compiled.get(text);
  if (!validate(message)) throw new Error(ajv.errorsText(validate.errors));
}

export const jsonOf = (data) => JSON.parse(new TextDecoder().decode(data));

/** A scene as a viewer has it: deletions first, then entities. */
export class Viewer {
  entities = new Map();
  deleted = 0;

  take({ deletions, entities }) {
    for (const { type, id } of deletions) {
      if (type === 1) this.entities.clear();
      else if (this.entities.delete(id)) ++this.deleted;
      else throw new Error(`deletion of ${id}, which was not there`);
    }
    for (const entity of entities) this.entities.set(entity.id, entity);
  }

  ids() {
    return [...this.entities.keys()].sort();
  }
}

/** The ids that a scene of this map (/api/v1/map) has. */
export function idsOf(map) {
  const ids = [...map.objects.map((o) => `object/${o.id}`), ...map.rooms.map((r) => `room/${r.id}`)];
  if (map.doorways.length > 0) ids.push("doorways");
  return ids.sort();
}

/** A folder that is gone after the tests. */
export function temporaryFolder() {
  const folder = mkdtempSync(join(tmpdir(), "kinemap-foxglove-"));
  process.on("exit", () => rmSync(folder, { recursive: true, force: true }));
  return folder;
}
