// Users of the page: who has logged in, and the way out (docs/web.md). Without users the server has none of this.

export const has_users = document.querySelector("meta[name=canopus-users]") !== null;
let key = "";

/// What the session's WebSocket and forms have to say; a page whose session is over goes to log in.
export async function key_of_session() {
  try {
    const answer = await fetch("session");
    if (answer.status === 401) location.assign("login");
    if (answer.ok) key = (await answer.json()).key;
  } catch {
    // The server does not answer; the WebSocket will not, either, and tries again.
  }
  return key;
}

const log_out = document.getElementById("log-out");
log_out.hidden = !has_users;
log_out.addEventListener("click", async () => {
  await fetch("logout", { method: "POST", body: new URLSearchParams({ key }) }).catch(() => {});
  location.assign("login");
});
