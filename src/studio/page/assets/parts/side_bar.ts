// SPDX-License-Identifier: Apache-2.0
import type {Member, Tab} from '../model/store';
import {CameraPanel} from './camera_panel';
import {FlyerList} from './flyer_list';
import {LightPanel} from './light_panel';
import {Part, attribute, h} from './part';
import {TextPanel} from './text_panel';

export const TABS: [Tab, string][] = [['flyers', 'Flyers'], ['light', 'Light'], ['camera', 'Camera'], ['text', 'Text']];

// The panels beside the picture, one at a time.
export class SideBar extends Part {
  protected readonly watches: Member[] = ['tab'];
  private tabs: HTMLButtonElement[] = [];
  private panels: HTMLElement[] = [];

  protected build(): void {
    this.tabs = TABS.map(
        ([tab, words], k) =>
            h('button', {
              role: 'tab',
              id: `tab-${tab}`,
              'aria-controls': `panel-${tab}`,
              title: `${words} (${k + 1})`,
              onclick: () => this.studio.store.put({tab})
            },
              words));
    const parts = [new FlyerList(), new LightPanel(), new CameraPanel(), new TextPanel()];
    this.panels = TABS.map(
        ([tab], k) => h('section', {role: 'tabpanel', id: `panel-${tab}`, 'aria-labelledby': `tab-${tab}`}, parts[k]));
    this.append(h('div', {role: 'tablist', 'aria-label': 'Panels'}, ...this.tabs), ...this.panels);
  }

  protected update(): void {
    TABS.forEach(([tab], k) => {
      attribute(this.tabs[k], 'aria-selected', String(tab === this.now.tab));
      this.panels[k].hidden = tab !== this.now.tab;
    });
  }
}
customElements.define('studio-side', SideBar);
