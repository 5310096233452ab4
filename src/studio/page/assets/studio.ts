// SPDX-License-Identifier: Apache-2.0
import {Connection} from './model/connection';
import {Store} from './model/store';
import {Studio} from './model/studio';
import {CameraPanel} from './parts/camera_panel';
import {FlyerList} from './parts/flyer_list';
import {FlyerPanel} from './parts/flyer_panel';
import {Gallery} from './parts/gallery';
import {HeightView} from './parts/height_view';
import {HelpDialog} from './parts/help_dialog';
import {LightPanel} from './parts/light_panel';
import {NoticeBar} from './parts/notice_bar';
import {provide, token} from './parts/part';
import {PictureView} from './parts/picture_view';
import {PlanView} from './parts/plan_view';
import {RenderDialog} from './parts/render_dialog';
import {SideBar} from './parts/side_bar';
import {StudioPage} from './parts/studio_page';
import {TextPanel} from './parts/text_panel';
import {TimeBar} from './parts/time_bar';
import {ToolBar} from './parts/tool_bar';

const ELEMENTS: Record<string, CustomElementConstructor> = {
  'studio-camera': CameraPanel,
  'studio-flyers': FlyerList,
  'studio-flyer': FlyerPanel,
  'studio-gallery': Gallery,
  'studio-height': HeightView,
  'studio-help': HelpDialog,
  'studio-light': LightPanel,
  'studio-notices': NoticeBar,
  'studio-picture': PictureView,
  'studio-plan': PlanView,
  'studio-render': RenderDialog,
  'studio-side': SideBar,
  'studio-text': TextPanel,
  'studio-time': TimeBar,
  'studio-tools': ToolBar,
  'airtruth-studio': StudioPage,
};

const studio =
    new Studio(new Store(sessionStorage), new Connection(`ws://${location.host}/ws?token=${token}`), sessionStorage);
provide(studio);
for (const [name, element] of Object.entries(ELEMENTS)) customElements.define(name, element);
window.addEventListener('pagehide', () => studio.end());
studio.begin();

// For tests: how long an event of a drag took until its picture was drawn, and whether all is at rest.
declare global {
  interface Window {
    airtruthStudio: {latencies_ms: number[]; isIdle: () => boolean; studio: Studio};
  }
}
window.airtruthStudio = {
  latencies_ms: studio.latencies_ms,
  isIdle: () => studio.isIdle,
  studio
};
