(* SPDX-License-Identifier: BSD-3-Clause *)
(** * The leaf: a direction (SEP) or a wall (WALL) that keeps two bodies apart *)
From Coq Require Import Reals ZArith Lia Lra Bool List.
From FclArtic Require Import Statement Numbers Trig Frames Enclose Reach Tube.
Import ListNotations.
Open Scope R_scope.

(** ** The leaf *)

(** A body, prepared, and what its pose gives; a partner with some of its pieces, the margin, rounded up, and the time up to which the pair is
    ignored, rounded down. *)
Record sbody := Sbody { sb_frame : nat; sb_place : step; sb_give : option give }.
Record partner := Partner { p_body : sbody; p_pieces : forest; p_margin : Z; p_from : Z }.

(** A function f(x) = v.x + d with constant v and d in a frame. It is to be above 0 on A and below on the partners; which
    of them is a wall, on all of which it is known to be so (or 0)? *)
Inductive side := NoWall | OwnWall | PartnersWall.
Record line := Line { l_frame : nat; l_func : func; l_side : side }.

(** A direction as three integers in units of 2^-64. *)
Definition along (i : nat) (x y z : Z) : line := Line i (Func (Tvec (const x 0) (const y 0) (const z 0)) tm_zero) NoWall.

Definition opposite (f : func) : func :=
  Func (Tvec (tm_opp (tx (fv f))) (tm_opp (ty (fv f))) (tm_opp (tz (fv f)))) (tm_opp (fd f)).

(** d - n.x of the wall n.x <= d; of the other side of a plane n.x - d. *)
Definition wall_func (o : outline) (turned : bool) : option func :=
  match o with
  | Outline _ _ => None
  | Wall n d both =>
      let f := Func (tm_point n) (tm_opp (tm_number d)) in
      if turned then (if both then Some f else None) else Some (opposite f)
  end.

(** The line of a wall, which A or the partner is. *)
Definition wall_line (A : sbody) (os : forest) (p : partner) (turned : bool) : option line :=
  match os, p_pieces p with
  | Piece (Wall _ _ _ as o), _ =>
      option_map (fun f => Line (sb_frame A) (up (sb_place A) f) OwnWall) (wall_func o turned)
  | _, Piece o =>
      option_map (fun f => Line (sb_frame (p_body p)) (up (sb_place (p_body p)) (opposite f)) PartnersWall)
        (wall_func o turned)
  | _, _ => None
  end.

(** At least the length of v. *)
Definition length_up (v : tvec) : Z :=
  Z.sqrt_up (bound (tx v) * bound (tx v) + bound (ty v) * bound (ty v) + bound (tz v) * bound (tz v)).

Definition own_reach (sd : side) (f : func) (l : Z) (os : forest) : option upper :=
  match sd with OwnWall => Some (upper_const 0) | _ => reach (opposite f) l os end.
Definition partners_reach (sd : side) (f : func) (l : Z) (os : forest) : option upper :=
  match sd with PartnersWall => Some (upper_const 0) | _ => reach f l os end.

(** The pieces of a body, seen from its frame and from all above it. *)
Definition views_up (fs : tree) (pl : plays) (A : sbody) (os : forest) : list view :=
  if negb (p_any pl) && is_none (sb_give A) then still_in (length fs) fs (sb_frame A)
  else moves (length fs) fs (p_gives pl) os (View (sb_frame A) (rise (sb_place A) at_rest) (move os (sb_give A) at_rest)).

Fixpoint view_at (i : nat) (l : list view) : option view :=
  match l with [] => None | v :: rest => if Nat.eqb (v_frame v) i then Some v else view_at i rest end.
(** From the first frame that both stand in. *)
Fixpoint common (a b : list view) : option (view * view) :=
  match a with
  | [] => None
  | v :: rest => match view_at (v_frame v) b with Some u => Some (v, u) | None => common rest b end
  end.
(** The frames from i, without it, down to the first of the list. *)
Fixpoint way_down (i : nat) (l : list view) (known : list nat) : list nat :=
  match l with
  | [] => known
  | v :: rest => if Nat.eqb (v_frame v) i then known else way_down i rest (v_frame v :: known)
  end.

(** [gap]: above -gap along a direction that is no longer than l. It remains if both stray as they do seen from one frame. *)
Definition remains (fs : tree) (l : Z) (gap : upper) (v u : view) : bool :=
  Nat.eqb (v_frame v) (v_frame u) && Nat.leb (v_frame v) (length fs) &&
  match upper_plus (v_stray v) (v_stray u) with Some k => negative (upper_add gap (upper_scale l k)) | None => false end.

(** The same, seen from the body B, in whose frame the view is. *)
Definition remains_in (fs : tree) (l : Z) (gap : upper) (os : forest) (B : sbody) (v : view) : bool :=
  negb (is_none (sb_give B)) && Nat.eqb (v_frame v) (sb_frame B) && Nat.leb (v_frame v) (length fs) &&
  let (_, w) := fall_all os [sb_place B] [sb_give B] (v_pose v) in
  match upper_plus (v_stray v) w with Some k => negative (upper_add gap (upper_scale l k)) | None => false end.

(** Seen from the frame that both stand in, or else from a frame between the two, or a body: distances are the same from
    everywhere. *)
Definition remains_on_the_way (fs : tree) (pl : plays) (l : Z) (gap : upper) (os : forest) (v : view) (B : sbody) (b : list view) : bool :=
  let down := v :: descend fs (p_gives pl) os v (way_down (v_frame v) b []) in
  existsb (fun v' => match view_at (v_frame v') b with Some u' => remains fs l gap v' u' | None => false end) (tl down) ||
  existsb (remains_in fs l gap os B) down.
Definition remains_somewhere (fs : tree) (pl : plays) (l : Z) (gap : upper) (A B : sbody) (os os' : forest) (a b : list view) : bool :=
  match common a b with
  | None => false
  | Some (v, u) =>
      remains fs l gap v u ||
      p_any pl && (remains_on_the_way fs pl l gap os v B b || remains_on_the_way fs pl l gap os' u A a)
  end.

(** (A value of a coinductive type is lazy in OCaml.) *)
CoInductive later := Later (views : list view).

Definition shown (fs : tree) (pl : plays) (known : list (nat * func)) (sd : side) (l : Z) (ua : option upper) (A : sbody)
    (os : forest) (views : later) (p : partner) : bool :=
  match at_frame (length fs) fs known (sb_frame (p_body p)) with
  | None => false
  | Some f =>
      match ua, partners_reach sd (down (sb_place (p_body p)) f) l (p_pieces p) with
      | Some u, Some w =>
          let gap := upper_add (upper_add u w) (upper_const (mulup (Z.max 0 (p_margin p)) l)) in
          negative gap &&
          match views with
          | Later a => remains_somewhere fs pl l gap A (p_body p) os (p_pieces p) a (views_up fs pl (p_body p) (p_pieces p))
          end
      | _, _ => false
      end
  end.

(** Poses are computed when they are first asked for, and kept: leaves ask for the same intervals of time. (A coinductive
    value is lazy in OCaml. In the proofs it is what it will be.) Intervals are kept down to a depth, for memory's sake. *)
CoInductive delayed := Delayed (fs : tree).
CoInductive poses := Poses (now : delayed) (halves : option (poses * poses)).

Definition middle (a b : Z) : Z := ((a + b) / 2)%Z.
CoFixpoint poses_from (depth : nat) (sfs : list sframe) (q : spiece) (a b : Z) : poses :=
  Poses (Delayed (tree_at sfs q a b))
    match depth with
    | O => None
    | S d => Some (poses_from d sfs q a (middle a b), poses_from d sfs q (middle a b) b)
    end.

Definition now (ts : poses) : tree := match ts with Poses (Delayed fs) _ => fs end.
Definition halves (sfs : list sframe) (q : spiece) (ts : poses) (a b : Z) : poses * poses :=
  match ts with
  | Poses _ (Some both) => both
  | Poses _ None => (poses_from 0 sfs q a (middle a b), poses_from 0 sfs q (middle a b) b)
  end.

(** Some 20,000 poses. *)
Definition kept_depth (sfs : list sframe) : nat := Z.to_nat (Z.log2 (20000 / (Z.of_nat (length sfs) + 1))).

Definition same (ts : poses) : poses := match ts with Poses x y => Poses x y end.
Lemma same_is ts : ts = same ts.
Proof. destruct ts. reflexivity. Qed.

Lemma now_is d sfs q a b : now (poses_from d sfs q a b) = tree_at sfs q a b.
Proof. rewrite (same_is (poses_from d sfs q a b)). destruct d; reflexivity. Qed.
Lemma halves_are d sfs q a b : exists e,
  halves sfs q (poses_from d sfs q a b) a b = (poses_from e sfs q a (middle a b), poses_from e sfs q (middle a b) b).
Proof.
  rewrite (same_is (poses_from d sfs q a b)). destruct d as [|d]; [exists O | exists d]; reflexivity.
Qed.

(** The partners that are not shown to be apart from pieces [os] of A. *)
Definition not_shown (fs : tree) (pl : plays) (A : sbody) (os : forest) (n : line) (ps : list partner) : list partner :=
  let known := chain (length fs) fs (l_frame n) (l_func n) in
  match at_frame (length fs) fs known (sb_frame A) with
  | None => ps
  | Some f =>
      let l := length_up (fv (l_func n)) in
      let ua := own_reach (l_side n) (down (sb_place A) f) l os in
      let views := Later (views_up fs pl A os) in
      filter (fun p => negb (shown fs pl known (l_side n) l ua A os views p)) ps
  end.

(** Over [a, b], of which [ts] are the poses. Time is halved for those that are left, [fuel] times. *)
Fixpoint separated (fuel : nat) (sfs : list sframe) (q : spiece) (pl : plays) (A : sbody) (os : forest) (n : line)
    (ps : list partner) (a b : Z) (ts : poses) : bool :=
  match ps with
  | [] => true
  | _ =>
      match not_shown (now ts) pl A os n ps with
      | [] => true
      | again =>
          match fuel with
          | O => false
          | S k =>
              let (first, second) := halves sfs q ts a b in
              separated k sfs q pl A os n again a (middle a b) first && separated k sfs q pl A os n again (middle a b) b second
          end
      end
  end.

(** F takes points of the body to its frame, F' to where they may be. *)
Definition stands (s : R) (A : sbody) (F F' : vec -> vec) : Prop :=
  holds_step s (sb_place A) F /\ isometry F' /\ onto F' /\ moves_by s (sb_give A) F F'.

(** A keeps more than its margin from a partner, where the frames may be at P'. *)
Definition keeps (P' : nat -> vec -> vec) (A : sbody) (os : forest) (p : partner) : Prop :=
  forall F F' G G', (forall s, stands s A F F') -> (forall s, stands s (p_body p) G G') ->
  forall x y o o', has os o -> (forall s, covers s o x) -> has (p_pieces p) o' -> (forall s, covers s o' y) ->
  V (p_margin p) < norm (sub (P' (sb_frame A) (F' x)) (P' (sb_frame (p_body p)) (G' y))).

Lemma length_up_ok s m v : Rabs s <= 1 -> holdsv m s v -> norm v <= V (length_up m).
Proof.
  intros Hs (Hx & Hy & Hz). apply (bound_ge _ s _ Hs) in Hx, Hy, Hz.
  eapply Rle_trans; [|apply (integer_length (bound (tx m)) (bound (ty m)) (bound (tz m)))].
  unfold norm. apply sqrt_le_1_alt. unfold dot; cbn [vx vy vz].
  assert (S : forall x y, Rabs x <= y -> x * x <= y * y).
  { intros x y H. apply abs_in in H. nra. }
  repeat apply Rplus_le_compat; apply S; assumption.
Qed.

Lemma opposite_ok s f v d : holdsf s f v d -> holdsf s (opposite f) (scale (-1) v) (- d).
Proof.
  intros ((A & B & C) & D). split; [|apply holds_opp; exact D]. unfold scale.
  repeat split; cbn [opposite fv tx ty tz vx vy vz];
    (eapply holds_eq; [|apply holds_opp; eassumption]; ring).
Qed.

(** The line keeps its promise: it is at least 0 on A if A is its wall, at most 0 on the partner if that is. *)
Definition line_ok (n : line) (A : sbody) (os : forest) (p : partner) : Prop :=
  forall s F G, Rabs s <= 1 -> holds_step s (sb_place A) F -> holds_step s (sb_place (p_body p)) G ->
  exists v d, holdsf s (l_func n) v d /\
    match l_side n with
    | NoWall => True
    | OwnWall => l_frame n = sb_frame A /\ forall o x, has os o -> covers s o x -> 0 <= dot v (F x) + d
    | PartnersWall =>
        l_frame n = sb_frame (p_body p) /\ forall o y, has (p_pieces p) o -> covers s o y -> dot v (G y) + d <= 0
    end.

Lemma along_ok i x y z A os p : line_ok (along i x y z) A os p.
Proof.
  intros s F G _ _ _. exists (Vec (V x) (V y) (V z)), 0. split; [|exact I].
  split; [repeat split; apply holds_exact | apply holds_zero].
Qed.

Lemma wall_func_ok s o turned f : wall_func o turned = Some f ->
  exists v d, holdsf s f v d /\ forall x, covers s o x -> 0 <= dot v x + d.
Proof.
  destruct o as [|n d both]; [discriminate|]. cbn [wall_func]. set (g := Func _ _).
  assert (H : holdsf s g (point n) (- real d)) by (split; [apply holdsv_point | apply holds_opp, holds_number]).
  destruct turned; [destruct both; [|discriminate]|]; intros [= <-].
  - exists (point n), (- real d). split; [exact H|]. intros x [_ E]. rewrite E by reflexivity. lra.
  - exists (scale (-1) (point n)), (- - real d). split; [apply opposite_ok; exact H|]. intros x [L _].
    replace (dot (scale (-1) (point n)) x) with (- dot (point n) x) by (unfold dot, scale; cbn [vx vy vz]; ring). lra.
Qed.

Lemma wall_line_ok A os p turned n : wall_line A os p turned = Some n -> line_ok n A os p.
Proof.
  assert (OWN : forall o f, wall_func o turned = Some f -> os = Piece o ->
    line_ok (Line (sb_frame A) (up (sb_place A) f) OwnWall) A os p).
  { intros o f W -> s F G Hs HF HG. destruct (wall_func_ok s o turned f W) as (v & d & Hf & K).
    destruct (up_ok s Hs _ F f v d HF Hf) as (v1 & d1 & H1 & _ & X). exists v1, d1. split; [exact H1|].
    split; [reflexivity|]. intros o' x <- C. rewrite X. apply K. exact C. }
  assert (PART : forall o f, wall_func o turned = Some f -> p_pieces p = Piece o ->
    line_ok (Line (sb_frame (p_body p)) (up (sb_place (p_body p)) (opposite f)) PartnersWall) A os p).
  { intros o f W E s F G Hs HF HG. destruct (wall_func_ok s o turned f W) as (v & d & Hf & K).
    destruct (up_ok s Hs _ G _ _ _ HG (opposite_ok s f v d Hf)) as (v1 & d1 & H1 & _ & X). exists v1, d1.
    split; [exact H1|]. split; [reflexivity|]. intros o' y I C. rewrite E in I. cbn [has] in I. subst o'.
    specialize (K y C). cbn [l_side]. rewrite X.
    replace (dot (scale (-1) v) y) with (- dot v y) by (unfold dot, scale; cbn [vx vy vz]; ring). lra. }
  assert (P : match p_pieces p with Piece o => option_map (fun f =>
      Line (sb_frame (p_body p)) (up (sb_place (p_body p)) (opposite f)) PartnersWall) (wall_func o turned)
      | _ => None end = Some n -> line_ok n A os p).
  { destruct (p_pieces p) as [o|] eqn:E; [|discriminate]. destruct (wall_func o turned) as [f|] eqn:W; [|discriminate].
    intros [= <-]. apply (PART o f W). first [exact E | reflexivity]. }
  unfold wall_line. destruct os as [o|]; [|exact P].
  destruct o as [c r|nn dd bb]; [exact P|]. destruct (wall_func (Wall nn dd bb) turned) as [f|] eqn:W; [|discriminate].
  intros [= <-]. exact (OWN _ f W eq_refl).
Qed.

(** Every frame but the world stands in one that is listed before it, and every body in a frame. *)
Definition well_formed (w : world) :=
  (forall i f, nth_error (frames w) i = Some f -> (parent f <= i)%nat) /\
  (forall b, In b (bodies w) -> (body_frame b <= length (frames w))%nat).

Section Sound.
Variable w : world.
Hypothesis WF : well_formed w.
Variable pc : piece.
Let sfs := map sframe_of (frames w).
Let q := spiece_of pc.

Lemma tree_parents a b k p sts : nth_error (tree_at sfs q a b) k = Some (p, sts) -> (p <= k)%nat.
Proof.
  unfold tree_at, tree_of, sfs. rewrite map_map, nth_error_map. destruct (nth_error (frames w) k) as [f|] eqn:N; [|discriminate].
  cbn. intros [= <- _]. apply (proj1 WF). exact N.
Qed.
Lemma tree_length a b : length (tree_at sfs q a b) = length (frames w).
Proof. unfold tree_at, tree_of, sfs. rewrite !map_length. reflexivity. Qed.

Lemma view_at_in i l v : view_at i l = Some v -> In v l.
Proof.
  induction l as [|u rest IH]; cbn [view_at In]; [discriminate|].
  destruct (Nat.eqb (v_frame u) i); [intros [= ->]; auto | auto].
Qed.
Lemma common_in a b v u : common a b = Some (v, u) -> In v a /\ In u b.
Proof.
  induction a as [|x rest IH]; cbn [common In]; [discriminate|].
  destruct (view_at (v_frame x) b) eqn:E; [intros [= <- <-]; split; [auto | exact (view_at_in _ _ _ E)]|].
  intros H. destruct (IH H). auto.
Qed.

Section Views.
Variables (s t : R) (a b : Z) (P P' : nat -> vec -> vec).
Hypothesis Hs : Rabs s <= 1.
Hypothesis Hts : holds (time_tm a b) s t.
Hypothesis HP : frames_at w (at_time pc t) P P'.
Let fs := tree_at sfs q a b.
Let pl := plays_of w q.

Lemma views_up_ok A os F F' x o : stands s A F F' -> has os o -> covers s o x ->
  forall v, In v (views_up fs pl A os) ->
  let X := P (sb_frame A) (F x) in let X' := P' (sb_frame A) (F' x) in
  seen_from s P P' (v_frame v) (v_stray v) X X' /\ (p_any pl = true -> seen s P P' v x X X').
Proof.
  intros (HF & _ & _ & HM) I C v. unfold views_up.
  destruct (negb (p_any pl) && is_none (sb_give A)) eqn:K; cbv zeta.
  - apply andb_true_iff in K. destruct K as [K1 K2]. apply negb_true_iff in K1.
    destruct (sb_give A); [discriminate|]. cbn [moves_by] in HM. rewrite HM. intros J. split; [|congruence].
    exact (still_in_ok w pc s t (time_tm a b) Hs Hts P P' HP K1 _ _ _ _ J).
  - intros J. assert (S : seen s P P' v x (P (sb_frame A) (F x)) (P' (sb_frame A) (F' x))); [|split; [exact (seen_is_from _ _ _ _ _ _ _ S) | auto]].
    revert J. apply (moves_ok s Hs fs (p_gives pl) P P') with (o := o); try assumption.
    + intros i k sts g. apply (frame_strays w pc s t (time_tm a b) Hs Hts P P' HP).
    + exists F, (F' x). cbn [v_frame v_pose v_stray]. split; [exact (rise_ok s Hs _ _ _ _ HF (at_rest_ok s))|].
      split; [intros y z; apply (step_keeps s _ _ y z HF)|]. split; [reflexivity|]. split; [reflexivity|].
      apply (move_ok s Hs os (sb_give A) at_rest F F' (fun y => y) o x HM (at_rest_ok s)); [intros y z; reflexivity | exact I | exact C].
Qed.

(** What remains of a gap g along a direction: more than r if both stray by r in all. *)
Definition remaining (l : Z) (gap : upper) (X Y X' Y' : vec) : Prop :=
  exists r k, 0 <= r /\ below k s r /\ negative (upper_add gap (upper_scale l k)) = true /\
    norm (sub X Y) - r <= norm (sub X' Y').

Lemma remains_ok l gap v u X Y X' Y' : remains fs l gap v u = true ->
  seen_from s P P' (v_frame v) (v_stray v) X X' -> seen_from s P P' (v_frame u) (v_stray u) Y Y' -> remaining l gap X Y X' Y'.
Proof.
  unfold remains. rewrite !andb_true_iff, Nat.eqb_eq, Nat.leb_le. intros [[E L] K] HX HY. rewrite <- E in HY.
  unfold fs in L. rewrite tree_length in L.
  destruct (seen_together w pc s t (time_tm a b) Hs Hts P P' HP (proj1 WF) _ _ _ _ _ _ _ L HX HY) as (r & R0 & B & N).
  destruct (upper_plus (v_stray v) (v_stray u)) as [k|]; [|discriminate]. exists r, k. auto.
Qed.

Lemma remaining_turned l gap X Y X' Y' : remaining l gap X Y X' Y' -> remaining l gap Y X Y' X'.
Proof.
  intros (r & k & R0 & B & N & D). exists r, k. repeat (split; [assumption|]).
  assert (SW : forall u v : vec, norm (sub u v) = norm (sub v u)) by (intros u v; apply norm_of_dots; destruct u, v; coords; ring).
  rewrite (SW Y X), (SW Y' X'). exact D.
Qed.

Lemma remains_in_ok l gap os o x X X' B G G' y v : has os o -> covers s o x -> seen s P P' v x X X' -> stands s B G G' ->
  remains_in fs l gap os B v = true -> remaining l gap X (P (sb_frame B) (G y)) X' (P' (sb_frame B) (G' y)).
Proof.
  intros Io Co (F & z' & HT & IF & EX & EX' & Bz) (HG & IG & OG & MG). unfold remains_in.
  rewrite !andb_true_iff, Nat.eqb_eq, Nat.leb_le. intros [[[_ E] L] K]. unfold fs in L. rewrite tree_length in L.
  assert (ST : strays s [sb_place B] [sb_give B] G G').
  { apply strays_first with (E := G) (E' := G') (M := fun z => z) (M' := fun z => z);
      [exact HG | exact IG | exact OG | exact MG | apply strays_no; reflexivity | reflexivity | reflexivity]. }
  pose proof (fall_all_ok s Hs os _ _ G G' ST (v_pose v) F o x z' (v_stray v) HT IF Io Co Bz) as FA.
  destruct (fall_all os [sb_place B] [sb_give B] (v_pose v)) as [T w']. destruct FA as (Y & Z' & _ & _ & EY & EZ & Bw).
  destruct (upper_plus (v_stray v) w') as [k|]; [|discriminate].
  destruct (frames_isometric w pc s t (time_tm a b) Hs Hts P P' HP (proj1 WF) _ _ (le_n _) L) as [I I'].
  exists (norm (sub Z' (Y x))), k. split; [apply norm_nonneg|]. split; [exact Bw|]. split; [exact K|].
  rewrite EX, EX', <- E, <- EY, <- EZ, (I _ _), (I' _ _), (IG _ _), (step_keeps s _ _ _ _ HG).
  pose proof (triangle_of (Y x) Z' y) as T1.
  assert (SW : norm (sub (Y x) Z') = norm (sub Z' (Y x))) by (apply norm_of_dots; generalize (Y x); intros u; destruct u, Z'; coords; ring). lra.
Qed.

Lemma on_the_way_ok l gap os o x X X' v B os' o' G G' y : has os o -> covers s o x -> seen s P P' v x X X' ->
  stands s B G G' -> has os' o' -> covers s o' y ->
  remains_on_the_way fs pl l gap os v B (views_up fs pl B os') = true ->
  remaining l gap X (P (sb_frame B) (G y)) X' (P' (sb_frame B) (G' y)).
Proof.
  intros Io Co HV HB Iy Cy. unfold remains_on_the_way. cbn [tl].
  assert (CH : forall i k sts g, nth_error fs i = Some (k, sts) -> nth_error (p_gives pl) i = Some g ->
    exists M M', strays s sts g M M' /\ (forall z, P (S i) z = P k (M z)) /\ (forall z, P' (S i) z = P' k (M' z)))
    by (intros i k sts g; apply (frame_strays w pc s t (time_tm a b) Hs Hts P P' HP)).
  pose proof (descend_ok s Hs fs (p_gives pl) P P' CH os o x X X' Io Co (way_down (v_frame v) (views_up fs pl B os') []) v HV) as D.
  rewrite orb_true_iff, !existsb_exists. intros [(v' & J & K)|(v' & J & K)].
  - destruct (view_at (v_frame v') _) as [u'|] eqn:V; [|discriminate].
    eapply remains_ok; [exact K | exact (seen_is_from _ _ _ _ _ _ _ (D v' J)) |].
    exact (proj1 (views_up_ok B os' G G' y o' HB Iy Cy u' (view_at_in _ _ _ V))).
  - eapply remains_in_ok; [exact Io | exact Co | | exact HB | exact K]. destruct J as [<-|J]; [exact HV | exact (D v' J)].
Qed.

Lemma remains_somewhere_ok A os p F F' G G' x y o o' l gap : stands s A F F' -> stands s (p_body p) G G' ->
  has os o -> covers s o x -> has (p_pieces p) o' -> covers s o' y ->
  remains_somewhere fs pl l gap A (p_body p) os (p_pieces p) (views_up fs pl A os) (views_up fs pl (p_body p) (p_pieces p)) = true ->
  remaining l gap (P (sb_frame A) (F x)) (P (sb_frame (p_body p)) (G y)) (P' (sb_frame A) (F' x)) (P' (sb_frame (p_body p)) (G' y)).
Proof.
  intros HA HB Ix Cx Iy Cy. pose proof (views_up_ok A os F F' x o HA Ix Cx) as SA.
  pose proof (views_up_ok (p_body p) (p_pieces p) G G' y o' HB Iy Cy) as SB. cbv zeta in SA, SB. unfold remains_somewhere.
  destruct (common _ _) as [[v u]|] eqn:E; [|discriminate]. destruct (common_in _ _ _ _ E) as [Iv Iu].
  rewrite orb_true_iff, andb_true_iff, orb_true_iff. intros [K|[N [K|K]]].
  - exact (remains_ok _ _ _ _ _ _ _ _ K (proj1 (SA v Iv)) (proj1 (SB u Iu))).
  - exact (on_the_way_ok l gap os o x _ _ v (p_body p) (p_pieces p) o' G G' y Ix Cx (proj2 (SA v Iv) N) HB Iy Cy K).
  - apply remaining_turned.
    exact (on_the_way_ok l gap (p_pieces p) o' y _ _ u A os o F F' x Iy Cy (proj2 (SB u Iu) N) HA Ix Cx K).
Qed.
End Views.

Lemma not_shown_ok A os n ps a b t P P' p : (l_frame n <= length (frames w))%nat -> line_ok n A os p ->
  V a <= t <= V b -> frames_at w (at_time pc t) P P' -> In p ps ->
  In p (not_shown (tree_at sfs q a b) (plays_of w q) A os n ps) \/ keeps P' A os p.
Proof.
  intros Hn LO Ht HP Ip. unfold not_shown. set (fs := tree_at sfs q a b).
  set (known := chain (length fs) fs (l_frame n) (l_func n)). set (l := length_up (fv (l_func n))).
  destruct (at_frame (length fs) fs known (sb_frame A)) as [f|] eqn:EA; [|left; exact Ip].
  set (ua := own_reach (l_side n) (down (sb_place A) f) l os).
  destruct (shown fs (plays_of w q) known (l_side n) l ua A os (Later (views_up fs (plays_of w q) A os)) p) eqn:ES.
  2:{ left. apply filter_In. split; [exact Ip|]. rewrite ES. reflexivity. }
  right. intros F F' G G' HFF HGG x y o o' Io Co Io' Co'.
  destruct (time_ok a b t Ht) as (s & Hs & Hts).
  specialize (HFF s). specialize (HGG s). pose proof (proj1 HFF) as HF. pose proof (proj1 HGG) as HG. specialize (Co s). specialize (Co' s).
  assert (CH : forall i k sts, nth_error fs i = Some (k, sts) ->
    exists E, holds_steps s sts E /\ forall x, P (S i) x = P k (E x)) by (eapply tree_ok; eassumption).
  destruct (LO s F G Hs HF HG) as (n0 & d0 & Hn0 & SIDE).
  destruct (chain_ok s Hs fs P (proj1 HP) CH (length fs) (l_frame n) (l_func n) n0 d0) as (wv & e & Nw & Xw & K).
  - intros k p' sts. apply tree_parents.
  - unfold fs. rewrite tree_length. exact Hn.
  - unfold fs. rewrite tree_length. exact Hn.
  - exact Hn0.
  - fold known in K.
    pose proof (at_frame_ok s Hs fs P CH (length fs) wv e known K (sb_frame A) f EA) as IA.
    destruct (body_ok s Hs P wv e _ f _ F IA HF) as (va & da & Ha & Na & Xa).
    unfold shown in ES.
    destruct (at_frame (length fs) fs known (sb_frame (p_body p))) as [g|] eqn:EB; [|discriminate].
    pose proof (at_frame_ok s Hs fs P CH (length fs) wv e known K _ g EB) as IB.
    destruct (body_ok s Hs P wv e _ g _ G IB HG) as (vb & db & Hb & Nb & Xb).
    assert (LN : forall v, dot v v = dot wv wv -> norm v <= V l).
    { intros v E. unfold norm. rewrite E, Nw. apply (length_up_ok s); [exact Hs | apply Hn0]. }
    assert (La : norm (scale (-1) va) <= V l).
    { apply LN. rewrite <- Na. unfold dot, scale; cbn. ring. }
    set (X := P (sb_frame A) (F x)) in *. set (Y := P (sb_frame (p_body p)) (G y)) in *.
    assert (E : dot (scale (-1) va) x + - da = - (dot wv X + e)).
    { unfold X. rewrite Xa. unfold dot, scale; cbn. ring. }
    assert (Ra : below_opt ua s (- (dot wv X + e))).
    { pose proof (reach_ok s Hs _ _ _ l os o x (opposite_ok _ _ _ _ Ha) La Io Co) as Ra. rewrite E in Ra.
      unfold ua, own_reach. destruct (l_side n); try exact Ra. destruct SIDE as [Q S].
      apply below_const. specialize (S o x Io Co). rewrite V_0. unfold X. rewrite <- Q, Xw. lra. }
    set (ub := partners_reach (l_side n) (down (sb_place (p_body p)) g) l (p_pieces p)) in *.
    assert (Rb : below_opt ub s (dot wv Y + e)).
    { pose proof (reach_ok s Hs _ _ _ l (p_pieces p) o' y Hb (LN _ Nb) Io' Co') as Rb. rewrite <- Xb in Rb.
      unfold ub, partners_reach. destruct (l_side n); try exact Rb. destruct SIDE as [Q S].
      apply below_const. specialize (S o' y Io' Co'). rewrite V_0. unfold Y. rewrite <- Q, Xw. exact S. }
    destruct ua as [u|]; [|discriminate]. destruct ub as [u'|]; [|discriminate].
    cbn [below_opt] in Ra, Rb. apply andb_true_iff in ES. destruct ES as [_ ES].
    destruct (remains_somewhere_ok s t a b P P' Hs Hts HP A os p F F' G G' x y o o' _ _ HFF HGG Io Co Io' Co' ES)
      as (r & k & R0 & Kr & NEG0 & NR). fold X Y in NR. clear ES.
    set (mz := Z.max 0 (p_margin p)) in *. destruct (V_max 0 (p_margin p)) as [M0 M1]. fold mz in M0, M1. rewrite V_0 in M0.
    assert (M : V mz * norm wv <= V (mulup mz l)).
    { eapply Rle_trans; [|apply mulup_ge]. apply Rmult_le_compat_l; [exact M0 | apply LN; reflexivity]. }
    assert (L0 : 0 <= V l) by (eapply Rle_trans; [apply norm_nonneg | exact La]).
    pose proof (below_negative _ s _ Hs NEG0 (below_add _ _ s _ _ (below_add _ _ s _ _ (below_add _ _ s _ _ Ra Rb)
      (below_const _ s _ M)) (below_scale s Hs l k r L0 Kr))) as NEG.
    assert (Mr : r * norm wv <= V l * r) by (rewrite Rmult_comm; apply Rmult_le_compat_r; [exact R0 | apply LN; reflexivity]).
    assert (D : (V mz + r) * norm wv < dot wv (sub X Y)).
    { replace (dot wv (sub X Y)) with (dot wv X - dot wv Y) by (unfold dot, sub, add, scale; cbn; ring). lra. }
    pose proof (cauchy wv (sub X Y)) as CS. pose proof (norm_nonneg wv).
    apply Rle_lt_trans with (V mz); [exact M1|]. apply Rlt_le_trans with (norm (sub X Y) - r); [|exact NR].
    apply Rnot_le_lt. intros L.
    assert (norm wv * norm (sub X Y) <= norm wv * (V mz + r)) by (apply Rmult_le_compat_l; lra). lra.
Qed.

Theorem separated_ok fuel A os n : (l_frame n <= length (frames w))%nat ->
  forall ps a b d, separated fuel sfs q (plays_of w q) A os n ps a b (poses_from d sfs q a b) = true ->
  forall t P P' p, line_ok n A os p -> V a <= t <= V b -> frames_at w (at_time pc t) P P' -> In p ps -> keeps P' A os p.
Proof.
  intros Hn. induction fuel as [|k IH]; intros ps a b d H t P P' p LO Ht HP Ip; cbn [separated] in H;
    (destruct ps as [|p0 ps0] eqn:EP; [destruct Ip|]; rewrite <- EP in *; clear EP p0 ps0);
    rewrite now_is in H; destruct (not_shown_ok A os n ps a b t P P' p Hn LO Ht HP Ip) as [I|K]; auto;
    destruct (not_shown (tree_at sfs q a b) (plays_of w q) A os n ps) as [|p' again]; try (destruct I; fail); try discriminate.
  destruct (halves_are d sfs q a b) as [e E]. rewrite E in H.
  apply andb_true_iff in H. destruct H as [H1 H2].
  destruct (Rle_lt_dec t (V (middle a b))) as [L|G]; [eapply IH; [exact H1 | exact LO | | exact HP | exact I]
                                                    | eapply IH; [exact H2 | exact LO | | exact HP | exact I]]; lra.
Qed.

End Sound.
