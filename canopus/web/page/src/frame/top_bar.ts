// The bar: which plant, whether it is simulated, live or a replay, plant time and its pace, Arm, the worst trouble, who one is.
import { html, nothing, type TemplateResult } from "lit";
import { worst_of } from "../store/nodes.js";
import type { App } from "./app.js";
import { iconLightDark, iconLock, iconLogOut, iconPause, iconPlay, iconPlayStepwise, iconSearch, iconSuccess, iconUnlock, iconError, iconWarning, iconInfo } from "./icons.js";
import { link } from "./route.js";
import { where_of } from "./where.js";

const speeds = [0.01, 0.1, 0.5, 1, 2, 5, 10, 20, 50, 100];
const steps = ["1ms", "10ms", "100ms", "1s", "10s"];

export class TopBar {
  private speed = 1;
  private step = "100ms";

  constructor(private readonly app: App, private readonly open_palette: () => void) {}

  /** Not on the start page, and not where there are settings of a module alone. */
  private get has_run(): boolean {
    const { store } = this.app;
    return !store.offers("plants") && store.hello?.buses.length !== 0;
  }

  private pace(): TemplateResult | typeof nothing {
    const { store } = this.app;
    if (!store.state || !store.offers("pace") || !this.has_run) return nothing;
    const stands = store.state.speed === 0;
    if (!stands) this.speed = store.state.speed;
    const off = !store.may_operate;
    const change = (wish: Record<string, unknown>): void => void this.app.run({ command: "pace", ...wish }, { done: "" });
    const known = speeds.includes(this.speed) ? speeds : [...speeds, this.speed].sort((a, b) => a - b);
    return html`<div class="pace" role="group" aria-label="Plant time">
      <ix-icon-button variant="subtle-tertiary" icon=${stands ? iconPlay : iconPause} ?disabled=${off} aria-label=${stands ? "Run" : "Pause"} title=${stands ? "Run" : "Pause"} @click=${() => change({ speed: stands ? this.speed : 0 })}></ix-icon-button>
      <ix-icon-button variant="subtle-tertiary" icon=${iconPlayStepwise} ?disabled=${off} aria-label="Step" title=${`Step ${this.step}`} @click=${() => change({ run: this.step })}></ix-icon-button>
      <select class="field" aria-label="Length of a step" ?disabled=${off} @change=${(event: Event) => { this.step = (event.target as HTMLSelectElement).value; this.app.redraw(); }}>${steps.map((one) => html`<option ?selected=${one === this.step}>${one}</option>`)}</select>
      <select class="field" aria-label="Speed of plant time" ?disabled=${off} @change=${(event: Event) => { this.speed = Number((event.target as HTMLSelectElement).value); if (!stands) change({ speed: this.speed }); }}>
        ${known.map((one) => html`<option value=${one} ?selected=${one === this.speed}>×${one}</option>`)}</select>
    </div>`;
  }

  private arm(): TemplateResult | typeof nothing {
    const { store, connection } = this.app;
    const has_live = store.hello ? [...store.hello.buses, ...store.hello.settings].some((one) => one.live) : false;
    if (!has_live || !store.may_operate) return nothing;
    const left = Math.ceil((store.armed_until - performance.now()) / 60_000);
    const is_armed = store.armed_until > 0;
    return html`<button type="button" class="field arm" aria-pressed=${is_armed} title=${is_armed ? "Writes on live buses are allowed; they are disarmed by themselves" : "Allow writes on live buses for 10 minutes"}
      @click=${async () => {
        const done = (await connection.commands.run({ command: "arm", on: !is_armed })) as unknown as { code: number; armed_for?: number; message: string };
        if (done.code === 0) store.set_armed(done.armed_for ?? 0, performance.now());
        else this.app.say(done.message, "error");
      }}><ix-icon aria-hidden="true" name=${is_armed ? iconUnlock : iconLock} size="16"></ix-icon>${is_armed ? `Armed, ${left} min` : "Arm writes"}</button>`;
  }

  private worst(): TemplateResult | typeof nothing {
    const { state, nodes } = this.app.store;
    if (!state || !this.has_run) return nothing;
    const worst = worst_of(state, nodes);
    if (!worst) return html`<span class="worst good"><ix-icon aria-hidden="true" name=${iconSuccess} size="16"></ix-icon>No trouble</span>`;
    return html`<a class="worst ${worst.node?.mood ?? "error"}" href=${worst.node ? link("overview", [], { node: worst.node.key }) : link("overview")} title=${worst.text}>
      <ix-icon aria-hidden="true" name=${worst.node?.mood === "warning" ? iconWarning : iconError} size="16"></ix-icon><span>${worst.text}</span></a>`;
  }

  view(): TemplateResult {
    const { store, connection } = this.app;
    const where = where_of(store);
    const has_users = document.querySelector("meta[name=canopus-users]") !== null;
    const dark = document.documentElement.dataset["ixColorSchema"] === "dark";
    return html`<ix-application-header data-where=${where.kind} hide-bottom-border>
      <div class="bar">
        <span class="plant" title=${store.state?.plant ?? ""}>${store.state?.plant || "Canopus"}</span>
        ${store.offers("plants") && where.kind !== "lost" ? nothing : html`<span class="where" role="status">${where.text}</span>`}
        ${!this.has_run ? nothing : html`<span class="time" title="Plant time" id="plant-time"></span>`}
        ${this.pace()}${this.arm()}${this.worst()}
        <span class="grows"></span>
        <button type="button" class="search field" @click=${this.open_palette}><ix-icon aria-hidden="true" name=${iconSearch} size="16"></ix-icon>Go to <kbd>Ctrl+K</kbd></button>
        <ix-icon-button variant="subtle-tertiary" icon=${iconInfo} aria-label=${this.app.is_described ? "Hide the description" : "Show the description"} title="Description (i)" @click=${() => this.app.show_description(!this.app.is_described)}></ix-icon-button>
        <ix-icon-button variant="subtle-tertiary" icon=${iconLightDark} aria-label=${dark ? "Light colours" : "Dark colours"} title=${dark ? "Light colours" : "Dark colours"} @click=${() => this.app.redraw()} data-scheme></ix-icon-button>
        <span class="role" title=${store.hello?.role === "look" && !has_users ? "The printed address contains a key. With it the page has full rights; without it the page is read-only." : `Role: ${store.hello?.role ?? ""}`}>${store.hello ? [store.hello.user, store.hello.role === "look" ? "read-only" : store.hello.role].filter(Boolean).join(", ") : ""}</span>
        ${has_users ? html`<ix-icon-button variant="subtle-tertiary" icon=${iconLogOut} aria-label="Log out" title="Log out" @click=${() => void connection.log_out()}></ix-icon-button>` : nothing}
      </div>
    </ix-application-header>`;
  }
}
