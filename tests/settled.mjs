// SPDX-License-Identifier: Apache-2.0
/**
 * Once the suit is silent, nothing waits for the solver and it is at nothing: no more news of this walk come.
 * @param {string} url of a kinemapd, with a slash at the end
 */
export async function settled(url) {
  for (let rests = 0; rests < 3; ) { // between two entries the solver is at none
    const metrics = await (await fetch(`${url}metrics`)).text();
    const values = (name) => [...metrics.matchAll(new RegExp(`^${name}\\S* (\\S+)`, "gm"))].map((m) => Number(m[1]));
    const atRest = values("kinemap_suit_silence_seconds")[0] > 4 && values("kinemap_solver_entry_age_seconds")[0] === 0;
    rests = atRest && values("kinemap_ring_depth").every((n) => n === 0) ? rests + 1 : 0;
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}
