// SPDX-License-Identifier: Apache-2.0
// The daemon's token: from the link that `kinemap pair` shows, or as the viewer types it; kept for the next visit.
const kKey = "kinemap-token";
const kInLink = /^#token=(.+)$/; // behind the #, which browsers keep to themselves

let token = read();

function read(): string | undefined {
  try {
    return localStorage.getItem(kKey) ?? undefined;
  } catch {
    return undefined; // the browser keeps nothing
  }
}

export function keepToken(text: string): void {
  token = text;
  try {
    localStorage.setItem(kKey, text);
  } catch {
    // for this visit only
  }
}

export function hasToken(): boolean {
  return token !== undefined;
}

/** Takes the token out of the address bar, where others could see it, and out of the browser's history. */
export function takeTokenFromLink(): void {
  const found = kInLink.exec(location.hash)?.[1];
  if (found === undefined) return;
  keepToken(decodeURIComponent(found));
  history.replaceState(null, "", location.pathname + location.search);
}

export function fetchWithToken(url: URL): Promise<Response> {
  return fetch(url, token === undefined ? {} : { headers: { Authorization: `Bearer ${token}` } });
}

/** A browser lets a page set no header of a WebSocket. */
export function streamUrl(base: URL): string {
  const url = new URL("api/v1/stream", base);
  url.protocol = url.protocol.replace("http", "ws");
  if (token !== undefined) url.searchParams.set("token", token);
  return url.href;
}

/** Saves what a link could not fetch, since it shows no token. */
export async function download(path: string, name: string): Promise<void> {
  const answer = await fetchWithToken(new URL(path, location.href));
  if (!answer.ok) return;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await answer.blob());
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}
