(* SPDX-License-Identifier: BSD-3-Clause *)
(** * What is claimed of a world and a motion

    This file is to be read by people: it is all that the theorems at the end of Walk.v are about. It says in real numbers
    what doc/CERTIFICATES.md, "What is claimed", says in words, for all but solids. *)
From Coq Require Import Reals ZArith String Bool List.
Import ListNotations.
Open Scope R_scope.

(** ** Vectors *)

Record vec := Vec { vx : R; vy : R; vz : R }.

Definition add (a b : vec) := Vec (vx a + vx b) (vy a + vy b) (vz a + vz b).
Definition scale (l : R) (a : vec) := Vec (l * vx a) (l * vy a) (l * vz a).
Definition sub (a b : vec) := add a (scale (-1) b).
Definition dot (a b : vec) := vx a * vx b + vy a * vy b + vz a * vz b.
Definition norm (a : vec) := sqrt (dot a a).
Definition cross (a b : vec) :=
  Vec (vy a * vz b - vz a * vy b) (vz a * vx b - vx a * vz b) (vx a * vy b - vy a * vx b).

(** No entry of [a] is off the one of [b] by more than [e]. *)
Definition near (e : R) (a b : vec) :=
  Rabs (vx a - vx b) <= e /\ Rabs (vy a - vy b) <= e /\ Rabs (vz a - vz b) <= e.

(** Matrices by their rows. *)
Record mat := Mat { row1 : vec; row2 : vec; row3 : vec }.

Definition apply (m : mat) (x : vec) := Vec (dot (row1 m) x) (dot (row2 m) x) (dot (row3 m) x).
Definition column1 (m : mat) := Vec (vx (row1 m)) (vx (row2 m)) (vx (row3 m)).
Definition column2 (m : mat) := Vec (vy (row1 m)) (vy (row2 m)) (vy (row3 m)).
Definition column3 (m : mat) := Vec (vz (row1 m)) (vz (row2 m)) (vz (row3 m)).

(** A proper rotation: columns of length 1, each normal to the others, right-handed. *)
Definition rotation (m : mat) :=
  dot (column1 m) (column1 m) = 1 /\ dot (column2 m) (column2 m) = 1 /\ dot (column3 m) (column3 m) = 1 /\
  dot (column1 m) (column2 m) = 0 /\ dot (column1 m) (column3 m) = 0 /\ dot (column2 m) (column3 m) = 0 /\
  dot (row1 m) (cross (row2 m) (row3 m)) = 1.

(** ** What the files hold *)

(** A double: mantissa * 2^exponent, exactly. *)
Record number := Number { mantissa : Z; exponent : Z }.
Record numbers3 := Numbers3 { n1 : number; n2 : number; n3 : number }.
Record stated_pose := Stated { r1 : numbers3; r2 : numbers3; r3 : numbers3; shift : numbers3 }.

Inductive element :=
  | Turn (axis : numbers3) (variable : nat) (multiplier offset : number)
  | Slide (axis : numbers3) (variable : nat) (multiplier offset : number)
  | Rotate (variable : nat).                              (* three variables from this one on: a rotation vector *)

(** Frame 0 is the world; the list of a world's frames begins with frame 1. *)
Record frame := Frame { parent : nat; origin : stated_pose; elements : list element }.

Inductive geometry :=
  | MeshSurface (triangles : list (numbers3 * numbers3 * numbers3))
  | Boxes (cells : list (numbers3 * numbers3))            (* centre, half sizes *)
  | Box (sizes : numbers3)
  | Sphere (radius : number)
  | Capsule (radius length : number)
  | Ellipsoid (semiaxes : numbers3)
  | Cylinder (radius length : number)
  | Cone (radius length : number)
  | Hull (points : list numbers3)
  | Halfspace (normal : numbers3) (offset : number)
  | Plane (normal : numbers3) (offset : number).

Inductive role := link | carried | obstacle.
Record body := Body {
  body_role : role; body_name : string; body_frame : nat; body_place : stated_pose; body_geometry : geometry }.

(** Pairs that are not checked, by names, and why. *)
Inductive reason := still | neighbours | allowed | touch_link.
Record unchecked_pair := Unchecked { why : reason; one_name : string; other_name : string }.

(** How far a pose may be off: turned by an angle about a point, then shifted by a length. *)
Record pose_tolerance := Tolerance { most_shift : number; most_angle : number; pivot : numbers3 }.

(** How far the real world may be off, by numbers of variables and frames and by names of bodies. *)
Record tolerances := Tolerances {
  of_variables : list (nat * number);                     (* each turn and slide by one *)
  of_vectors : list (nat * number);                       (* the slide by one, in any direction *)
  of_rotations : list (nat * number);                     (* each `Rotate` of one *)
  of_frames : list (nat * pose_tolerance);
  of_bodies : list (string * pose_tolerance) }.

Record world := World {
  frames : list frame;
  bodies : list body;
  margins : list (string * number);
  pair_margins : list (string * string * number);
  unchecked : list unchecked_pair;
  off : tolerances }.

(** A piece has a polynomial for each variable, by its coefficients of 1, t, t^2, ...; the nine numbers of rotations with
    which `Rotate` of a variable begins; and pairs of bodies, the lower number first, that are ignored up to a time. *)
Record piece := Piece {
  polynomials : list (list number);
  orientations : list (nat * (numbers3 * numbers3 * numbers3));
  ignored : list (nat * nat * number) }.
Record motion := Motion {
  general_margin : number; added_margin : number;
  scope_self : bool; scope_scene : bool;
  until : number;                                         (* of the last piece *)
  pieces : list piece }.

(** ** What they mean *)

Definition real (x : number) : R := IZR (mantissa x) * powerRZ 2 (exponent x).
Definition point (p : numbers3) : vec := Vec (real (n1 p)) (real (n2 p)) (real (n3 p)).

(** The value of a variable at time t. *)
Fixpoint polynomial (coefficients : list number) (t : R) : R :=
  match coefficients with [] => 0 | c :: rest => real c + t * polynomial rest t end.
Definition value (p : piece) (t : R) (variable : nat) : R := polynomial (nth variable (polynomials p) []) t.
Definition orientation (p : piece) (variable : nat) : option (numbers3 * numbers3 * numbers3) :=
  option_map snd (find (fun o => Nat.eqb (fst o) variable) (orientations p)).

(** What frames depend on: the values of the variables, and where rotations begin. *)
Record state := State { amount : nat -> R; start : nat -> option (numbers3 * numbers3 * numbers3) }.
Definition at_time (p : piece) (t : R) : state := State (value p t) (orientation p).

(** Rodrigues' formula: the turn by [angle] about the unit vector [k]. *)
Definition turn (k : vec) (angle : R) (x : vec) : vec :=
  add (add (scale (cos angle) x) (scale (sin angle) (cross k x))) (scale ((1 - cos angle) * dot k x) k).

(** The turn about w by its length. *)
Definition rotate (w : vec) : vec -> vec := turn (scale (/ norm w) w) (norm w).

(** The rotations that nine numbers may mean: all within 2^-49. *)
Definition rotation_means (a b c : numbers3) (m : mat) :=
  rotation m /\ near (/ 2 ^ 49) (row1 m) (point a) /\ near (/ 2 ^ 49) (row2 m) (point b) /\
  near (/ 2 ^ 49) (row3 m) (point c).
Definition start_map (o : option (numbers3 * numbers3 * numbers3)) (M : vec -> vec) : Prop :=
  match o with
  | None => forall x, M x = x
  | Some (a, b, c) => exists m, rotation_means a b c m /\ forall x, M x = apply m x
  end.

(** The unit vectors that an axis may mean: exactly the one along it, if two of its numbers are 0; else all that are
    off it by 2^-50 at most. *)
Definition coordinate_axis (a : vec) :=
  (vx a = 0 /\ vy a = 0) \/ (vx a = 0 /\ vz a = 0) \/ (vy a = 0 /\ vz a = 0).
Definition axis_means (a k : vec) :=
  dot k k = 1 /\ near (/ 2 ^ 50) k (scale (/ norm a) a) /\ (coordinate_axis a -> k = scale (/ norm a) a).

(** *** Tolerances

    What no tolerance is stated of is not off at all. *)
Definition most (list : list (nat * number)) (i : nat) : R :=
  match find (fun e => Nat.eqb (fst e) i) list with Some e => real (snd e) | None => 0 end.
Definition frame_tolerance (w : world) (i : nat) : option pose_tolerance :=
  option_map snd (find (fun e => Nat.eqb (fst e) i) (of_frames (off w))).
Definition body_tolerance (w : world) (b : body) : option pose_tolerance :=
  option_map snd (find (fun e => String.eqb (fst e) (body_name b)) (of_bodies (off w))).

(** A turn about some axis through the origin, by no more than [most]. *)
Definition small_turn (most : R) (D : vec -> vec) : Prop :=
  exists k angle, dot k k = 1 /\ Rabs angle <= most /\ forall x, D x = turn k angle x.

(** How a pose may be off: G takes the points from where they are to where they may be. *)
Definition pose_off (tolerance : option pose_tolerance) (G : vec -> vec) : Prop :=
  match tolerance with
  | None => forall x, G x = x
  | Some t => exists D u, small_turn (real (most_angle t)) D /\ norm u <= real (most_shift t) /\
      forall x, G x = add (add (point (pivot t)) (D (sub x (point (pivot t))))) u
  end.

(** [element_map w q e E E']: in the state q, E is a map (of points of the element's own frame) that the element may mean,
    and E' is where it may be instead. A turn is about the same axis, by an angle that may be another one; a slide may
    be longer or shorter, and may stray in a direction of its own; a rotation is followed by a small turn. Each element
    is off by itself, also where several have one variable. *)
Inductive element_map (w : world) (q : state) : element -> (vec -> vec) -> (vec -> vec) -> Prop :=
  | turn_map a k v m c e : axis_means (point a) k -> Rabs e <= most (of_variables (off w)) v ->
      element_map w q (Turn a v m c) (turn k (real m * amount q v + real c)) (turn k (real m * (amount q v + e) + real c))
  | slide_map a k v m c e u : axis_means (point a) k -> Rabs e <= most (of_variables (off w)) v ->
      norm u <= Rabs (real m) * most (of_vectors (off w)) v ->
      element_map w q (Slide a v m c) (fun x => add x (scale (real m * amount q v + real c) k))
        (fun x => add (add x (scale (real m * (amount q v + e) + real c) k)) u)
  | rotate_map v S D : start_map (start q v) S -> small_turn (most (of_rotations (off w)) v) D ->
      let R x := rotate (Vec (amount q v) (amount q (v + 1)) (amount q (v + 2))) (S x) in
      element_map w q (Rotate v) R (fun x => D (R x)).

Inductive elements_map (w : world) (q : state) : list element -> (vec -> vec) -> (vec -> vec) -> Prop :=
  | no_element : elements_map w q [] (fun x => x) (fun x => x)
  | first_element e es E E' M M' : element_map w q e E E' -> elements_map w q es M M' ->
      elements_map w q (e :: es) (fun x => E (M x)) (fun x => E' (M' x)).

(** The maps that twelve numbers may mean: a rotation, and exactly the translation. *)
Inductive pose_map (p : stated_pose) : (vec -> vec) -> Prop :=
  | pose_means m : rotation_means (r1 p) (r2 p) (r3 p) m -> pose_map p (fun x => add (apply m x) (point (shift p))).

(** [P i x] is where the motion has the point x of frame i in the world, [P' i x] where it may be instead. Rotations and
    axes are the same for both. *)
Definition frames_at (w : world) (q : state) (P P' : nat -> vec -> vec) : Prop :=
  (forall x, P O x = x) /\ (forall x, P' O x = x) /\
  (forall i f, nth_error (frames w) i = Some f ->
     exists O G M M', pose_map (origin f) O /\ pose_off (frame_tolerance w (S i)) G /\ elements_map w q (elements f) M M' /\
       (forall x, P (S i) x = P (parent f) (O (M x))) /\ forall x, P' (S i) x = P' (parent f) (O (G (M' x)))).

(** ** Geometry *)

Inductive in_hull (corners : list vec) : vec -> Prop :=
  | corner p : In p corners -> in_hull corners p
  | between x y l : in_hull corners x -> in_hull corners y -> 0 <= l <= 1 ->
      in_hull corners (add (scale l x) (scale (1 - l) y)).

Definition in_box (half : vec) (x : vec) :=
  Rabs (vx x) <= vx half /\ Rabs (vy x) <= vy half /\ Rabs (vz x) <= vz half.

Definition inside (g : geometry) (x : vec) : Prop :=
  match g with
  | MeshSurface triangles =>
      exists a b c, In (a, b, c) triangles /\ in_hull [point a; point b; point c] x
  | Boxes cells => exists centre half, In (centre, half) cells /\ in_box (point half) (sub x (point centre))
  | Box sizes => in_box (scale (/ 2) (point sizes)) x
  | Sphere r => norm x <= real r
  | Capsule r l => exists z, - real l / 2 <= z <= real l / 2 /\ norm (sub x (Vec 0 0 z)) <= real r
  | Ellipsoid a => exists u, norm u <= 1 /\
      x = Vec (real (n1 a) * vx u) (real (n2 a) * vy u) (real (n3 a) * vz u)
  | Cylinder r l => norm (Vec (vx x) (vy x) 0) <= real r /\ - real l / 2 <= vz x <= real l / 2
  | Cone r l => exists h, 0 <= h <= 1 /\                  (* h: part of the way from the base to the apex *)
      norm (Vec (vx x) (vy x) 0) <= (1 - h) * real r /\ vz x = h * real l - real l / 2
  | Hull points => in_hull (map point points) x
  | Halfspace n d => dot (point n) x <= real d
  | Plane n d => dot (point n) x = real d
  end.

(** y is where a point of body b stands in the world: B takes points of its geometry to its frame. *)
Definition occupies (P : nat -> vec -> vec) (b : body) (B : vec -> vec) (y : vec) :=
  exists x, inside (body_geometry b) x /\ y = P (body_frame b) (B x).

(** ** Pairs and margins *)

Definition is_obstacle (b : body) := match body_role b with obstacle => true | _ => false end.
Definition same_names (x y a b : string) :=
  (String.eqb x a && String.eqb y b) || (String.eqb x b && String.eqb y a).

(** All pairs are checked but two bodies of one frame, two obstacles, listed ones, and those out of the scope. *)
Definition checked (w : world) (m : motion) (a b : body) : bool :=
  negb (Nat.eqb (body_frame a) (body_frame b)) &&
  negb (is_obstacle a && is_obstacle b) &&
  negb (existsb (fun u => same_names (one_name u) (other_name u) (body_name a) (body_name b)) (unchecked w)) &&
  (if is_obstacle a || is_obstacle b then scope_scene m else scope_self m).

Definition own_margin (w : world) (a : body) : option number :=
  option_map snd (find (fun e => String.eqb (fst e) (body_name a)) (margins w)).
Definition pair_margin (w : world) (a b : body) : option number :=
  option_map snd
    (find (fun e => same_names (fst (fst e)) (snd (fst e)) (body_name a) (body_name b)) (pair_margins w)).

(** The pair's own, else the largest of the bodies' own, else the motion's; and what is added. *)
Definition margin (w : world) (m : motion) (a b : body) : R :=
  real (added_margin m) +
  match pair_margin w a b, own_margin w a, own_margin w b with
  | Some x, _, _ => real x
  | None, Some x, Some y => Rmax (real x) (real y)
  | None, Some x, None => real x
  | None, None, Some y => real y
  | None, None, None => real (general_margin m)
  end.

(** ** Reasons

    Of the reasons for which a pair is not checked, these are claims. *)
Definition frame_at (w : world) (i : nat) : option frame := match i with O => None | S k => nth_error (frames w) k end.
Definition elements_at (w : world) (i : nat) : list element :=
  match frame_at w i with Some f => elements f | None => [] end.

(** The frames from i up to its ancestor c, without c. *)
Inductive way_up (w : world) : nat -> nat -> list nat -> Prop :=
  | arrived c : way_up w c c []
  | one_up i f c l : frame_at w i = Some f -> way_up w (parent f) c l -> way_up w i c (i :: l).

(** [l] has the frames between those of a and b that a common ancestor c does not carry along. *)
Definition between_frames (w : world) (a b : body) (c : nat) (l : list nat) : Prop :=
  exists up down, way_up w (body_frame a) c up /\ way_up w (body_frame b) c down /\ l = up ++ down.

Definition moves (w : world) (i : nat) : bool := match elements_at w i with [] => false | _ => true end.

(** Whether elements move freely: they slide by two variables, or rotate after they slid. [slid]: by which variables. *)
Fixpoint free (slid : list nat) (es : list element) : bool :=
  match es with
  | [] => false
  | Turn _ _ _ _ :: rest => free slid rest
  | Slide _ v _ _ :: rest => existsb (fun u => negb (Nat.eqb u v)) slid || free (v :: slid) rest
  | Rotate _ :: rest => match slid with [] => free slid rest | _ => true end
  end.

Definition is_link (b : body) : Prop := body_role b = link.

Definition reason_holds (w : world) (why : reason) (a b : body) : Prop :=
  match why with
  | allowed => True                                       (* the user's word *)
  | touch_link =>
      body_role a <> obstacle /\ body_role b <> obstacle /\ (body_role a = carried \/ body_role b = carried)
  | still => exists c l, between_frames w a b c l /\ forall i, In i l -> moves w i = false
  | neighbours =>
      is_link a /\ is_link b /\
      exists c l, between_frames w a b c l /\
        (length (filter (moves w) l) <= 1)%nat /\
        (* no frame between them carries a link *)
        (forall i d, In i (c :: l) -> i <> body_frame a -> i <> body_frame b ->
           In d (bodies w) -> is_link d -> body_frame d <> i) /\
        (* what moves freely there stands on what moves *)
        (forall i f, In i l -> frame_at w i = Some f -> free [] (elements f) = true ->
           exists k up, way_up w (parent f) k up /\ moves w k = true)
  end.

(** ** The claim *)

(** The claim is about something: at every time frames and bodies can stand as the world says, and need not be off. *)
Definition meaningful (w : world) (m : motion) :=
  (forall p t, In p (pieces m) -> exists P, frames_at w (at_time p t) P P) /\
  (forall b, In b (bodies w) -> exists B, pose_map (body_place b) B /\ pose_off (body_tolerance w b) (fun x => x)).

(** In the state q, whatever the rotations and axes mean, and however frames and bodies are off within their tolerances,
    the points of a and b keep their distance. *)
Definition apart (w : world) (m : motion) (q : state) (a b : body) : Prop :=
  forall P P' A B F G, frames_at w q P P' -> pose_map (body_place a) A -> pose_map (body_place b) B ->
  pose_off (body_tolerance w a) F -> pose_off (body_tolerance w b) G ->
  forall x y, occupies P' a (fun p => A (F p)) x -> occupies P' b (fun p => B (G p)) y -> norm (sub x y) > margin w m a b.

(** When a piece's part of the claim ends: the last one at [until], the others at 1. *)
Definition ends (m : motion) (k : nat) : R :=
  if Nat.eqb (S k) (length (pieces m)) then real (until m) else 1.

(** A piece begins where the one before ends: each turn and slide differs by 2^-29 and 2^-39 of it (2^-20 at most). The
    rotation of a frame with `Rotate` differs by 2^-27 in each entry; these are the ways of the frame's coordinate axes. *)
Definition way (M : vec -> vec) (axis : vec) := sub (M axis) (M (Vec 0 0 0)).
Definition element_joined (w : world) (p p' : piece) (f : frame) (e : element) : Prop :=
  match e with
  | Turn _ v m _ | Slide _ v m _ =>
      let x := real m * value p 1 v in
      Rabs (x - real m * value p' 0 v) <= / 2 ^ 29 + Rmin (Rabs x / 2 ^ 39) (/ 2 ^ 20)
  | Rotate _ =>
      forall O M M' N N', pose_map (origin f) O -> elements_map w (at_time p 1) (elements f) M N ->
      elements_map w (at_time p' 0) (elements f) M' N' ->
      forall axis, In axis [Vec 1 0 0; Vec 0 1 0; Vec 0 0 1] ->
      near (/ 2 ^ 27) (way (fun x => O (M x)) axis) (way (fun x => O (M' x)) axis)
  end.
Definition joined (w : world) (p p' : piece) : Prop :=
  forall f e, In f (frames w) -> In e (elements f) -> element_joined w p p' f e.

(** Bodies i and j are checked at time t of piece k, and have a point in common there on the motion itself, wherever
    rotations and axes let the frames stand; or, if only [near], points that are no farther from each other than the margin. *)
Definition meets (w : world) (m : motion) (near : bool) (k i j : nat) (t : number) : Prop :=
  exists p a b, nth_error (pieces m) k = Some p /\ nth_error (bodies w) i = Some a /\ nth_error (bodies w) j = Some b /\
  (i < j)%nat /\ checked w m a b = true /\ 0 <= real t <= 1 /\ (forall u, In (i, j, u) (ignored p) -> real u < real t) /\
  forall P P' A B, frames_at w (at_time p (real t)) P P' -> pose_map (body_place a) A -> pose_map (body_place b) B ->
  exists x y, occupies P a A x /\ occupies P b B y /\ if near then norm (sub x y) <= margin w m a b else x = y.

(** Each pair that is listed as unchecked has the reason that is given. *)
Definition reasons (w : world) : Prop :=
  forall a b u, In a (bodies w) -> In b (bodies w) -> In u (unchecked w) ->
  body_frame a <> body_frame b -> is_obstacle a && is_obstacle b = false ->
  same_names (one_name u) (other_name u) (body_name a) (body_name b) = true -> reason_holds w (why u) a b.

Definition claim (w : world) (m : motion) : Prop :=
  meaningful w m /\ reasons w /\
  (forall k p p', nth_error (pieces m) k = Some p -> nth_error (pieces m) (S k) = Some p' -> joined w p p') /\
  forall k p, nth_error (pieces m) k = Some p ->
  forall i j a b, (i < j)%nat -> nth_error (bodies w) i = Some a -> nth_error (bodies w) j = Some b ->
  checked w m a b = true ->
  forall t, 0 <= t <= ends m k -> (forall u, In (i, j, u) (ignored p) -> real u < t) ->
  apart w m (at_time p t) a b.
