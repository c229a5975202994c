/**
 * Which tab this is: an id that outlives a reload. A copy of a tab, which copies its storage too, is another tab;
 * it is known by the lock that the first one holds as long as it is there.
 */

const KEY = "vsw-tab";

function made() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return [...bytes].map((b) => b.toString(16).padStart(2, "0")).join("");
}

/** Hold the lock of an id until the tab goes; false when another tab holds it. */
function hold(id) {
  const locks = globalThis.navigator?.locks; // only there where the page came from this machine or by https
  if (!locks) return Promise.resolve(true);
  return new Promise((tell) => {
    locks
      .request(`${KEY}-${id}`, { ifAvailable: true }, (lock) => {
        tell(Boolean(lock));
        return lock ? new Promise(() => {}) : undefined;
      })
      .catch(() => tell(true));
  });
}

async function find() {
  const storage = globalThis.sessionStorage;
  const before = storage.getItem(KEY) ?? "";
  const own = Boolean(before) && (await hold(before));
  const id = own ? before : made();
  if (!own) await hold(id);
  storage.setItem(KEY, id);
  return { id, earlier: own ? "" : before };
}

let found = null;

/** Return {id, earlier}; `earlier` is the id of the tab that this is a copy of. Null where nothing may be stored. */
export function tabId() {
  found ??= find().catch(() => null);
  return found;
}
