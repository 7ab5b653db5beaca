// How fast plant time goes: run, pause, a step, faster and slower. Only where no bus is a real one.
import { make, set_text } from "./dom.js";

const speeds = [0.01, 0.1, 0.5, 1, 2, 5, 10, 20, 50, 100];
const steps = ["1ms", "10ms", "100ms", "1s", "10s"];

export class PaceControls {
  constructor(box, commands) {
    this.box = box;
    this.commands = commands;
    this.run = make("button", { type: "button" }, "Pause");
    this.step = make("button", { type: "button" }, "Step");
    this.length = make("select", { "aria-label": "Length of a step" }, ...steps.map((one) => make("option", {}, one)));
    this.length.value = "100ms";
    this.speed = make("select", { "aria-label": "Speed of plant time" }, ...speeds.map((one) => make("option", { value: one }, `×${one}`)));
    this.speed.value = "1";
    this.said = make("span", { role: "status" });
    box.append(this.run, this.step, this.length, this.speed, this.said);
    this.run.addEventListener("click", () => this.change({ speed: this.now === 0 ? Number(this.speed.value) : 0 }));
    this.step.addEventListener("click", () => this.change({ run: this.length.value }));
    this.speed.addEventListener("change", () => this.now !== 0 && this.change({ speed: Number(this.speed.value) }));
  }

  greeted(hello) {
    this.box.hidden = hello.role === "look" || !hello.offers.includes("pace") || hello.offers.includes("plants");
  }

  async change(wish) {
    const done = await this.commands.run({ command: "pace", ...wish });
    set_text(this.said, done.code === 0 ? "" : done.message ?? "no answer");
  }

  /// What the bar says beside where it is: "×2", "PAUSED".
  draw(state) {
    this.now = state.speed;
    set_text(this.run, this.now === 0 ? "Run" : "Pause");
    if (this.now !== 0 && document.activeElement !== this.speed) this.speed.value = String(this.now);
    return this.now === 0 ? " PAUSED" : this.now === 1 ? "" : ` ×${this.now}`;
  }
}
