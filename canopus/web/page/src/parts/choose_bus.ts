// The choice among the buses that have a project.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../frame/app.js";
import type { Project } from "../store/project.js";

export function choose_bus(app: App, screen: string, project: Project): TemplateResult | typeof nothing {
  if (app.projects.length < 2) return nothing;
  return html`<label class="inline">Bus <select class="field" @change=${(event: Event) => app.go(screen, [(event.target as HTMLSelectElement).value])}>${app.projects.map((one) => html`<option ?selected=${one === project}>${one.bus.bus}</option>`)}</select></label>`;
}
