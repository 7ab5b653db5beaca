// Where what is shown happens: simulated, live, or a replay; and whether it is old.
import type { Store } from "../store/store.js";

export interface Where {
  text: string;
  kind: "simulated" | "live" | "replay" | "lost";
}

/** "SIMULATED ×1", "LIVE can0", "REPLAY"; and where what is shown is old. */
export function where_of(store: Pick<Store, "connection" | "state" | "hello" | "is_live">): Where {
  if (store.connection === "lost") return { text: "NOT CONNECTED", kind: "lost" };
  if (store.connection === "silent") return { text: "NO ANSWER", kind: "lost" };
  const { state } = store;
  if (!state) return { text: "CONNECTING", kind: "lost" };
  const links = state.buses.filter((bus) => bus.link !== "sim").map((bus) => bus.link.replace(/^[a-z]+:/, ""));
  const gone = state.buses.some((bus) => bus.gone) ? " GONE" : "";
  if (store.is_live) {
    const plc = store.hello?.buses.length === 0 ? store.hello.settings[0]?.plc.find((one) => one.startsWith("--host="))?.slice(7) : undefined;
    return { text: `LIVE ${plc ? `PLC ${plc}` : links.join(", ")}${gone}`.trim(), kind: "live" };
  }
  if (links.length) return { text: `REPLAY${gone}`, kind: "replay" };
  return { text: state.speed === 0 ? "SIMULATED PAUSED" : `SIMULATED ×${state.speed}`, kind: "simulated" };
}
