// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState } from "preact/hooks";

/** Asks for the token, once: over all else, since without it there is nothing to see. */
export function TokenPrompt({ wrong, onToken }: { wrong: boolean; onToken: (token: string) => void }) {
  const dialog = useRef<HTMLDialogElement>(null);
  const [text, setText] = useState("");
  useEffect(() => dialog.current?.showModal(), []);
  return (
    <dialog ref={dialog} class="token-prompt" aria-labelledby="token-title" onCancel={(event) => event.preventDefault()}>
      <form
        onSubmit={(event) => {
          event.preventDefault();
          if (text.trim()) onToken(text.trim());
        }}
      >
        <h2 id="token-title">Token</h2>
        <p>
          This map is not for everybody. <code>kinemap pair</code>, on the wearable PC, shows the token and a code to scan.
        </p>
        <label for="token">Token</label>
        <input id="token" type="password" autocomplete="off" value={text} onInput={(event) => setText(event.currentTarget.value)} />
        {wrong && <p role="alert">The daemon does not know this token.</p>}
        <button type="submit" disabled={!text.trim()}>
          Show the map
        </button>
      </form>
    </dialog>
  );
}
