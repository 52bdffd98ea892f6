// SPDX-License-Identifier: Apache-2.0
// What the page says about link and suit: one sentence, and what to do.
import { duration, timeOfDay } from "../format";
import type { State } from "../store";

export interface SuitState {
  /** live: all is well; wait: nothing to worry about; bad: something must be done. */
  tone: "live" | "wait" | "bad";
  title: string;
  /** For how long, where that matters. */
  lasted?: string;
  detail?: string;
}

const listening = ({ transport, address, port }: { transport: string; address: string; port: number }) =>
  `${transport.toUpperCase()} ${address === "0.0.0.0" ? "" : `${address}, `}port ${port}`;

export function suitState({ link, status }: State, now: number): SuitState {
  if (link.phase === "lost") {
    const wait = Math.max(0, Math.ceil(((link.retryAt ?? now) - now) / 1000));
    const lasted = duration((now - link.since) / 1000);
    return {
      tone: "bad",
      title: "Link lost",
      lasted,
      detail: `No word from Kinemap since ${timeOfDay(link.since)}, ${lasted} ago. ${wait > 0 ? `Trying again in ${wait} s.` : "Trying again now."}`,
    };
  }
  if (link.phase === "connecting" || !status) return { tone: "wait", title: "Connecting", detail: "Asking Kinemap for the map." };
  const { suit } = status;
  if (suit.refusal) return { tone: "bad", title: "Suit refused", detail: suit.refusal };
  if (suit.receiving) return { tone: "live", title: "Live" };
  if (suit.silence_s !== undefined) {
    const since = now - suit.silence_s * 1000;
    return {
      tone: "wait",
      title: "Suit silent",
      lasted: duration(suit.silence_s),
      detail: `The last frame came at ${timeOfDay(since)}, ${duration(suit.silence_s)} ago. The map stays as it is.`,
    };
  }
  return {
    tone: "wait",
    title: "No suit yet",
    detail: `Listening on ${listening(suit)}. In MVN: Options › Preferences › Network Streamer, add this computer's address and that port.`,
  };
}
