// The components of Siemens iX that the page uses; others are not in the bundle.
import { defineCustomElement as application } from "@siemens/ix/components/ix-application.js";
import { defineCustomElement as application_header } from "@siemens/ix/components/ix-application-header.js";
import { defineCustomElement as button } from "@siemens/ix/components/ix-button.js";
import { defineCustomElement as empty_state } from "@siemens/ix/components/ix-empty-state.js";
import { defineCustomElement as icon_button } from "@siemens/ix/components/ix-icon-button.js";
import { defineCustomElement as icon } from "@siemens/ix-icons/components/ix-icon.js";
import { defineCustomElement as menu } from "@siemens/ix/components/ix-menu.js";
import { defineCustomElement as menu_item } from "@siemens/ix/components/ix-menu-item.js";

export function define_components(): void {
  for (const define of [icon, application, application_header, button, empty_state, icon_button, menu, menu_item]) define();
}
