// What stands where a screen needs a project and there is none.
import { html, type TemplateResult } from "lit";
import type { App } from "../frame/app.js";

export function no_project(app: App): TemplateResult {
  if (!app.store.hello) return html`<p class="faint">Waiting for the run …</p>`;
  return html`<ix-empty-state header="No project" sub-header="A bus of a plant has one by the key project in the plant file. The start page of a folder opens projects, and makes new ones."></ix-empty-state>`;
}
