/**
 * A band that says when the page has lost its server: until then every control would look alive and do nothing.
 */

const TOLD =
  "Connection lost – the server stopped or the network is down; reload when it is back: what you did before is kept, what you change until then is not.";

/**
 * Build the band and let it follow the connection of a document.
 * @param {{on_event: Function}} doc the Bokeh document of the page; missing in an export without a server
 * @returns {HTMLElement}
 */
export function buildConnection(doc) {
  const band = document.createElement("div");
  band.className = "notice err band connection";
  band.setAttribute("role", "alert");
  band.hidden = true;
  const text = document.createElement("span");
  const reload = document.createElement("button");
  reload.type = "button";
  reload.textContent = "Reload";
  reload.onclick = () => globalThis.location.reload();
  band.append(text, reload);
  const show = (lost) => {
    text.textContent = lost ? `✕ ${TOLD}` : ""; // set when it is shown: an alert is read when its text changes
    band.hidden = !lost;
  };
  if (doc?.config && "notify_connection_status" in doc.config) {
    doc.config.notify_connection_status = false; // one message, not this one and Bokeh's own
    doc.config.reconnect_session = false; // a server that was started anew knows nothing of this tab
  }
  doc?.on_event?.("connection_lost", () => show(true));
  doc?.on_event?.("client_reconnected", () => show(false));
  return band;
}
