// SPDX-License-Identifier: Apache-2.0
// The stream's WebSocket: opens it, notices when it is gone even if nobody says so, and opens it again.
import type { Link } from "./store";

const kSilenceMs = 4000; // the status comes once a second: silence means that the link is gone
const kShortestPauseMs = 500;
const kLongestPauseMs = 10000;

export interface LinkHandlers {
  onLink(link: Link): void;
  onOpen(send: (message: object) => void): void;
  onMessage(message: unknown): void;
}

export class StreamLink {
  private socket?: WebSocket;
  private pause = kShortestPauseMs;
  private retry?: ReturnType<typeof setTimeout>;
  private watchdog?: ReturnType<typeof setTimeout>;
  private link: Link = { phase: "connecting", since: Date.now() };

  constructor(
    private url: () => string,
    private handlers: LinkHandlers,
  ) {
    addEventListener("online", () => this.hurry());
    document.addEventListener("visibilitychange", () => document.visibilityState === "visible" && this.hurry());
    this.open();
  }

  /** Tries at once instead of at the end of the pause. */
  hurry(): void {
    if (this.link.phase === "open" || this.socket) return;
    clearTimeout(this.retry);
    this.open();
  }

  private open(): void {
    const socket = new WebSocket(this.url());
    this.socket = socket;
    this.listen(kSilenceMs);
    socket.onopen = () => this.handlers.onOpen((message) => socket.send(JSON.stringify(message)));
    socket.onmessage = (event) => {
      this.listen(kSilenceMs);
      if (this.link.phase !== "open") this.change({ phase: "open", since: Date.now() });
      this.pause = kShortestPauseMs;
      this.handlers.onMessage(JSON.parse(String(event.data)));
    };
    socket.onclose = () => this.lost();
  }

  private listen(ms: number): void {
    clearTimeout(this.watchdog);
    this.watchdog = setTimeout(() => this.lost(), ms);
  }

  private lost(): void {
    clearTimeout(this.watchdog);
    const socket = this.socket;
    if (!socket) return;
    this.socket = undefined;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
    // A little chance keeps many pages from coming back in the same instant.
    const pause = this.pause * (0.8 + 0.4 * Math.random());
    this.pause = Math.min(this.pause * 2, kLongestPauseMs);
    const since = this.link.phase === "lost" ? this.link.since : Date.now();
    this.change({ phase: "lost", since, retryAt: Date.now() + pause });
    this.retry = setTimeout(() => this.open(), pause);
  }

  private change(link: Link): void {
    this.link = link;
    this.handlers.onLink(link);
  }
}
