// The line with which a screen begins: its title, what it is about, what can be done.
import { html, type TemplateResult } from "lit";

export function head(title: string, about: unknown, ...actions: unknown[]): TemplateResult {
  return html`<header class="head"><h1 id="screen-title" tabindex="-1">${title}</h1><span class="about">${about}</span><span class="grows"></span>${actions}</header>`;
}
